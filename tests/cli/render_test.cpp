#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

class Render : public testing::Test {
 protected:
  Render() {
    cli::write_small_sequence(folder_ / "00", 8);
    const cli::Answer answer = cli::run({"run", folder_ / "00", "--out", run(), "--threads", "1"});
    if (answer.exit_code != 0) throw std::runtime_error(answer.err);
  }
  std::string run() const { return folder_ / "runs/mine"; }

  TempFolder folder_;
};

TEST_F(Render, DrawsAScanWithoutBrowserAndTheSameEachTime) {
  for (const char* name : {"a.png", "b.png"}) {
    const cli::Answer answer =
        cli::run({"render", run(), "--scan", "6", "-o", folder_ / name, "--size", "400"});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    EXPECT_THAT(answer.out, HasSubstr("scan 000006 of 00 in "));
  }
  const std::string bytes = read_file(folder_ / "a.png");
  EXPECT_TRUE(bytes.starts_with("\x89PNG"));
  EXPECT_EQ(bytes, read_file(folder_ / "b.png"));
  EXPECT_EQ(cli::run({"render", run(), "--scan", "worst", "-o", folder_ / "w.png"}).exit_code, 0);
}

TEST_F(Render, DrawsTheSameOfLabelsThatWereScored) {
  const std::string net = folder_ / "net";
  ASSERT_EQ(cli::run({"score", folder_ / "00", "--predictions", run(), "--out", net}).exit_code, 0);
  for (const auto& [from, name] : {std::pair{run(), "run.png"}, std::pair{net, "net.png"}}) {
    const cli::Answer answer = cli::run({"render", from, "--scan", "6", "-o", folder_ / name});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
  }
  EXPECT_EQ(read_file(folder_ / "run.png"), read_file(folder_ / "net.png"));
}

TEST_F(Render, RefusesScansAndSequencesThatAreNotThere) {
  for (const char* scan : {"8", "-1", "best", ""}) {
    const cli::Answer answer = cli::run({"render", run(), "--scan", scan, "-o", folder_ / "r.png"});
    EXPECT_EQ(answer.exit_code, 2) << scan;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "r.png"));
  }
  const cli::Answer answer =
      cli::run({"render", run(), "--sequence", "01", "--scan", "1", "-o", folder_ / "r.png"});
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.err, HasSubstr("holds results of 00, expected --sequence to name one"));
}

}  // namespace
}  // namespace mosbench
