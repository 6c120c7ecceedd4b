#include <gtest/gtest.h>

#include <stdexcept>

#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

/// Returns what telling and going on by two scans prints on stderr.
std::string printed() {
  testing::internal::CaptureStderr();
  tell("a note");
  Progress progress("title", 2);
  progress.advance();
  progress.advance();
  return testing::internal::GetCapturedStderr();
}

TEST(Caller, SilencesNotesAndProgressWhileItIsNamed) {
  {
    const CallerScope scope({.quiet = true});
    EXPECT_EQ(printed(), "");
  }
  const std::string loud = printed();
  EXPECT_NE(loud.find("a note"), std::string::npos);
  EXPECT_NE(loud.find("title: scan 2/2"), std::string::npos);
}

TEST(Caller, IsAskedAfterEachScanAndMayEndTheWork) {
  int asked = 0;
  const CallerScope scope({.quiet = true, .at_each_scan = [&] {
                             if (++asked == 2) throw std::runtime_error("enough");
                           }});
  Progress progress("title", 3);
  progress.advance();
  EXPECT_THROW(progress.advance(), std::runtime_error);
  EXPECT_EQ(asked, 2);
}

}  // namespace
}  // namespace mosbench
