#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/formats/times_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kScansInRoom = 14;

/// Scans every 0.1 s.
class ScanRangeCommand : public testing::Test {
 protected:
  ScanRangeCommand() {
    cli::write_small_sequence(folder_ / "room", kScansInRoom);
    std::vector<std::int64_t> stamps_ns;
    for (std::size_t k = 0; k < kScansInRoom; ++k) {
      stamps_ns.push_back(static_cast<std::int64_t>(k) * 100'000'000);
    }
    write_times(folder_ / "room/times.txt", stamps_ns);
  }
  cli::Answer ask(const std::string& command, const std::string& scans,
                  const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {command, folder_ / "room", "--scans", scans};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }

  TempFolder folder_;
};

TEST_F(ScanRangeCommand, RunsAndScoresOnlyTheseScansUnderTheirNames) {
  const cli::Answer run = ask("run", "3:13:2", {"--out", folder_ / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out + run.err, HasSubstr("only a part of the sequence is read: 3:13:2, 5 of 14"));
  const auto result = cli::timeless_result(folder_ / "out/room");
  ASSERT_EQ(result.at("scans").size(), 5U);
  EXPECT_EQ(result.at("scans").at(4).at("stem"), "000011");
  EXPECT_EQ(result.at("reading").at("scans"), "3:13:2, 5 of 14 scans");
  EXPECT_TRUE(is_there(folder_ / "out/room/labels/000011.label"));
  EXPECT_FALSE(is_there(folder_ / "out/room/labels/000004.label"));
  EXPECT_FALSE(result.contains("scans_left_out"));

  // The same words keep it, other ranges are another run.
  EXPECT_THAT(ask("run", "3:13:2", {"--out", folder_ / "out"}).err, HasSubstr("kept"));
  const cli::Answer other = ask("run", "3:", {"--out", folder_ / "out"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("3:13:2, 5 of 14"));

  // Its labels and those of all scans are scored over the same five; the whole misses some.
  for (const auto& labels : {folder_ / "out", folder_ / "all"}) {
    if (labels == folder_ / "all") std::filesystem::copy(folder_ / "room/labels", labels);
    const cli::Answer score = ask("score", "3:13:2", {"--predictions", labels, "--json"});
    ASSERT_EQ(score.exit_code, 0) << score.err;
    const ordered_json json = ordered_json::parse(score.out);
    EXPECT_EQ(json.at("sequences").at(0).at("summary").at("labelled_scans"), 5);
  }
  const cli::Answer whole = cli::run({"score", folder_ / "room", "--predictions", folder_ / "out"});
  EXPECT_EQ(whole.exit_code, 3);
  EXPECT_THAT(whole.err, HasSubstr("a prediction for every scan with truth"));
  const cli::Answer report = cli::run({"report", folder_ / "out", "-o", folder_ / "report.html"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
}

TEST_F(ScanRangeCommand, IsTakenByEveryCommandThatReadsSequences) {
  EXPECT_THAT(ask("doctor", "::2").out, HasSubstr("7 scans"));
  const cli::Answer converted =
      ask("convert", "4:9", {"--layout", "semantickitti", "--out", folder_ / "converted"});
  ASSERT_EQ(converted.exit_code, 0) << converted.err;
  EXPECT_THAT(converted.out, HasSubstr("converted 5 scans"));
  const cli::Answer profile = ask("profile", "6", {"--json", folder_ / "profile.json"});
  ASSERT_EQ(profile.exit_code, 0) << profile.err;
  const auto json = ordered_json::parse(read_file(folder_ / "profile.json"));
  EXPECT_EQ(json.at("sequences").at(0).at("scans").size(), 6U);
  const cli::Answer stats =
      ask("stats", "4:9", {"--by", "range", "--predictions", folder_ / "room/labels"});
  EXPECT_THAT(stats.err, HasSubstr("holds the truth"));
}

TEST_F(ScanRangeCommand, PosesOfAPartNeedStamps) {
  const cli::Answer kitti = ask("odometry", "2:9", {"-o", folder_ / "part.txt"});
  EXPECT_EQ(kitti.exit_code, 2);
  EXPECT_THAT(kitti.err, AllOf(HasSubstr("--scans: KITTI's rows belong to all scans of room"),
                               HasSubstr("*.tum")));
  EXPECT_FALSE(is_there(folder_ / "part.txt"));
  const cli::Answer found = ask("odometry", "2:9", {"-o", folder_ / "part.tum"});
  ASSERT_LE(found.exit_code, 1) << found.err;
  EXPECT_THAT(found.out, HasSubstr("7 poses"));
  EXPECT_THAT(found.out, HasSubstr("--scans 2:9"));
  const cli::Answer run = ask(
      "run", "2:9", {"--poses", folder_ / "part.tum", "--out", folder_ / "out", "--threads", "1"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, Not(HasSubstr("left out")));
  EXPECT_EQ(cli::timeless_result(folder_ / "out/room").at("scans").size(), 7U);
}

TEST_F(ScanRangeCommand, RefusesRangesWithoutAScanAndPositions) {
  const cli::Answer beyond = ask("run", "14:", {"--out", folder_ / "out"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_THAT(beyond.err, HasSubstr("--scans 14: chooses no scan of sequence room, which has 14 "
                                    "scans, expected some of 0 to 13"));
  const cli::Answer empty = ask("run", "5:5");
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err,
              HasSubstr("--scans: '5:5' is no range of scans, expected a TO above FROM"));
  std::string rows;
  for (std::size_t k = 1; k <= 5; ++k) rows += std::to_string(k) + "\n";
  folder_.write("rows/room.txt", rows);
  const cli::Answer answer = ask("score", "5:10", {"--predictions", folder_ / "rows"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("names scans by their position, and 9 of sequence room are "
                                    "left out, expected files named like the scans"));
}

}  // namespace
}  // namespace mosbench
