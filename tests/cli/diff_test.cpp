#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
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

TEST_F(Diff, FindsTheObjectsWhereTheFirstRunReadThem) {
  const cli::Answer answer =
      cli::run({"compare", folder_ / "delay_0", folder_ / "delay_2", "--by", "object", "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(nlohmann::json::parse(answer.out).at("disagreeing_objects"), 1);
}

TEST_F(Diff, RefusesADataSetThatIsNotTheOneOfTheRuns) {
  cli::write_small_sequence(folder_ / "hall", 12);
  const cli::Answer other = diff("hall");
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("hall: has none of the sequences that both runs hold"));

  cli::write_small_sequence(folder_ / "shorter/room", 9);
  EXPECT_THAT(diff("shorter").err,
              HasSubstr("delay_0/room/result.json: was made from other scans, poses or labels"));

  cli::write_small_sequence(folder_ / "changed/room", 12);
  const std::filesystem::path file = folder_ / "changed/room/labels/000005.label";
  auto labels = read_labels(file, cli::kPointsPerScan);
  labels.front() = kMovingLabel;
  write_labels(file, labels);
  const cli::Answer changed = diff("changed");
  EXPECT_EQ(changed.exit_code, 3);
  EXPECT_THAT(changed.err, HasSubstr("was made from other scans, poses or labels than"));
}

TEST_F(Diff, ReadsTheDataSetAsTheRunsReadIt) {
  // Without the poses of the runs the folder cannot be opened at all.
  std::filesystem::rename(folder_ / "room/poses.txt", folder_ / "found.txt");
  for (const char* delay : {"0", "2"}) {
    ASSERT_EQ(cli::run({"run", folder_ / "room", "--out", folder_ / (std::string("posed_") + delay),
                        "--poses", folder_ / "found.txt", "--bin-columns", "4", "--set",
                        std::string("delay_scans=") + delay})
                  .exit_code,
              0);
  }
  const cli::Answer answer = cli::run(
      {"diff", folder_ / "posed_0", folder_ / "posed_2", "--data", folder_ / "room", "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(nlohmann::json::parse(answer.out).at("disagreeing_objects"), 1);
  const cli::Answer broken_down = cli::run({"breakdown", folder_ / "posed_0"});
  EXPECT_EQ(broken_down.exit_code, 0) << broken_down.err;
}

TEST_F(Diff, ComparesObjectsOfRunsWithOtherPosesByThoseOfTheFirst) {
  std::filesystem::copy_file(folder_ / "room/poses.txt", folder_ / "same.txt");
  ASSERT_EQ(cli::run({"run", folder_ / "room", "--out", folder_ / "posed_2", "--poses",
                      folder_ / "same.txt", "--set", "delay_scans=2"})
                .exit_code,
            0);
  const cli::Answer answer =
      cli::run({"diff", folder_ / "delay_0", folder_ / "posed_2", "--data", folder_ / "room"});
  EXPECT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_EQ(answer.out.substr(answer.out.find("object")), [&] {
    const std::string out = diff("room").out;
    std::string named = out.substr(out.find("object"));
    named.replace(named.find("delay_2"), 7, "posed_2");
    return named;
  }());
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
