#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "datasets/formats/label_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// Two runs of a small sequence that find different parts of its object.
class Diff : public testing::Test {
 protected:
  Diff() {
    cli::write_small_sequence(folder_ / "room", 12);
    for (const char* delay : {"0", "2"}) {
      const cli::Answer run =
          cli::run({"run", folder_ / "room", "--out", folder_ / (std::string("delay_") + delay),
                    "--set", std::string("delay_scans=") + delay});
      if (run.exit_code != 0) throw std::runtime_error(run.err);
    }
  }
  cli::Answer diff(const std::string& root) const {
    return cli::run({"diff", folder_ / "delay_0", folder_ / "delay_2", "--data", folder_ / root});
  }

  TempFolder folder_;
};

TEST_F(Diff, SaysThatRunsWithoutTruthCannotBeCompared) {
  std::filesystem::remove_all(folder_ / "room/labels");
  ASSERT_EQ(cli::run({"run", folder_ / "room", "--out", folder_ / "untold"}).exit_code, 0);
  const cli::Answer answer = cli::run({"diff", folder_ / "delay_0", folder_ / "untold"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("untold/room/result.json: has no scan with truth"));
}

TEST_F(Diff, HeadsItsColumnsWithTheNamesOfTheRuns) {
  const cli::Answer answer = diff("room");
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, testing::ContainsRegex("delay_0 IoU % +delay_2 IoU %"));
  EXPECT_THAT(answer.out, testing::ContainsRegex("delay_0 found +delay_2 found"));
}

TEST_F(Diff, RefusesADataSetThatIsNotTheOneOfTheRuns) {
  cli::write_small_sequence(folder_ / "hall", 12);
  const cli::Answer other = diff("hall");
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("hall: has none of the sequences that both runs hold"));

  cli::write_small_sequence(folder_ / "shorter/room", 9);
  EXPECT_THAT(diff("shorter").err, HasSubstr("has no truth for scan 000009 of sequence room"));

  cli::write_small_sequence(folder_ / "changed/room", 12);
  const std::filesystem::path file = folder_ / "changed/room/labels/000005.label";
  auto labels = read_labels(file, cli::kPointsPerScan);
  labels.front() = kMovingLabel;
  write_labels(file, labels);
  const cli::Answer changed = diff("changed");
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_THAT(changed.err, HasSubstr("has another truth for scan 000005 of sequence room"));
}

TEST_F(Diff, RefusesLabelsThatWereChangedAfterTheRun) {
  const std::filesystem::path file = folder_ / "delay_0/room/labels/000009.label";
  auto labels = read_labels(file, cli::kPointsPerScan);
  // As many move as before.
  std::reverse(labels.begin(), labels.end());
  ASSERT_NE(labels, read_labels(file, cli::kPointsPerScan));
  write_labels(file, labels);
  const cli::Answer answer = diff("room");
  EXPECT_EQ(answer.exit_code, 3) << answer.out;
  EXPECT_THAT(answer.err, HasSubstr("000009.label: does not give the counts in result.json"));
}

}  // namespace
}  // namespace mosbench
