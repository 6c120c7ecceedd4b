#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

TEST(Info, TellsWhatARecordingIsAndWhatToTypeNext) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 5);
  const cli::Answer answer = cli::run({"info", folder / "room"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("semantickitti data set, 1 sequence"));
  EXPECT_THAT(answer.out, HasSubstr("5, 5 with truth"));
  EXPECT_THAT(answer.out, HasSubstr("no stamps: windows in seconds count as at 10 Hz"));
  EXPECT_THAT(answer.out, HasSubstr("0.0 m by poses.txt"));
  EXPECT_THAT(answer.out, HasSubstr("8640 in scan 2, 0 of them missing returns"));
  EXPECT_THAT(answer.out, HasSubstr("360 degrees around"));
  EXPECT_THAT(answer.out, HasSubstr("`mosbench run " + (folder / "room").string() + "`"));
  const cli::Answer json = cli::run({"info", folder / "room", "--json"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  EXPECT_THAT(json.out, HasSubstr("\"field of view\""));
}

TEST(Info, NeedsNoPoses) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", 5);
  std::filesystem::remove(folder / "room/poses.txt");
  const cli::Answer answer = cli::run({"info", folder / "room"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("not known: no poses"));
  EXPECT_THAT(answer.out, HasSubstr("--odometry simple` finds what moves"));
}

TEST(Info, OfNothingIsAnError) {
  const TempFolder folder;
  EXPECT_EQ(cli::run({"info", folder / "gone"}).exit_code, 3);
  EXPECT_EQ(cli::run({"info"}).exit_code, 2);
}

}  // namespace
}  // namespace mosbench
