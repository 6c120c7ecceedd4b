#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/formats/times_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kScansWithGaps = 12;

/// Scans every 0.1 s, and stamped poses of which those of 0.3 to 0.8 s are lost.
class PoseGaps : public testing::Test {
 protected:
  PoseGaps() {
    cli::write_small_sequence(folder_ / "room", kScansWithGaps);
    std::string poses;
    std::vector<std::int64_t> stamps_ns;
    for (std::size_t k = 0; k < kScansWithGaps; ++k) {
      stamps_ns.push_back(static_cast<std::int64_t>(k) * 100'000'000);
      const std::string stamp = std::to_string(k / 10) + '.' + std::to_string(k % 10);
      if (k < 3 || k > 8) poses += stamp + " 0 0 0 0 0 0 1\n";
    }
    write_times(folder_ / "room/times.txt", stamps_ns);
    folder_.write("gap.tum", poses);
  }
  cli::Answer ask(const std::string& command, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {command, folder_ / "room", "--poses", folder_ / "gap.tum"};
    words.insert(words.end(), more.begin(), more.end());
    return cli::run(words);
  }

  TempFolder folder_;
};

TEST_F(PoseGaps, AreLeftOutCountedAndRecorded) {
  const cli::Answer run = ask("run", {"--out", folder_ / "out"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("room: 6 of 12 scans are left out: they lie between poses more "
                                 "than 0.5 s apart in gap.tum (--read max_pose_gap_s)"));
  const auto result = cli::timeless_result(folder_ / "out/room");
  EXPECT_EQ(result.at("scans").size(), 6U);
  EXPECT_EQ(result.at("scans_left_out").dump(),
            R"(["000003","000004","000005","000006","000007","000008"])");
  EXPECT_THAT(result.at("reading").at("pose_pairing").get<std::string>(),
              HasSubstr("6 of 12 scans are left out"));
  EXPECT_THAT(ask("run", {"--out", folder_ / "out"}).err, HasSubstr("kept"));

  // Its labels, and those of all scans, are scored over the same scans.
  for (const auto& labels : {folder_ / "out", folder_ / "all"}) {
    if (labels == folder_ / "all") {
      std::filesystem::copy(folder_ / "room/labels", labels);
    }
    const cli::Answer score = ask("score", {"--predictions", labels, "--json"});
    ASSERT_EQ(score.exit_code, 0) << score.err;
    const auto summary = nlohmann::json::parse(score.out).at("sequences").at(0).at("summary");
    EXPECT_EQ(summary.at("labelled_scans"), 6);
  }
  const cli::Answer report = cli::run({"report", folder_ / "out", "-o", folder_ / "report.html"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
}

TEST_F(PoseGaps, AreLeftOutByEveryCommandThatReadsPoses) {
  EXPECT_THAT(ask("doctor").out, HasSubstr("6 of 12 scans are left out"));
  const cli::Answer converted =
      ask("convert", {"--layout", "semantickitti", "--out", folder_ / "converted"});
  ASSERT_EQ(converted.exit_code, 0) << converted.err;
  EXPECT_FALSE(is_there(folder_ / "converted/sequences/room/velodyne/000006.bin"));
  const cli::Answer longer = ask("run", {"--out", folder_ / "longer", "--max-pose-gap-s", "0.7"});
  ASSERT_EQ(longer.exit_code, 0) << longer.err;
  EXPECT_THAT(longer.out, Not(HasSubstr("left out")));
  EXPECT_EQ(cli::timeless_result(folder_ / "longer/room").at("scans").size(), kScansWithGaps);
  const cli::Answer report =
      cli::run({"report", folder_ / "longer", "-o", folder_ / "report.html"});
  EXPECT_EQ(report.exit_code, 0) << report.err;
  EXPECT_EQ(ask("run", {"--out", folder_ / "x", "--max-pose-gap-s", "-1"}).exit_code, 2);
  EXPECT_EQ(ask("run", {"--out", folder_ / "x", "--max-pose-gap-s", "nan"}).exit_code, 2);
}

TEST_F(PoseGaps, MakePositionsOfScansDoubtful) {
  std::string rows;
  for (std::size_t k = 1; k <= 6; ++k) rows += std::to_string(k) + "\n";
  folder_.write("rows/room.txt", rows);
  const cli::Answer answer = ask("score", {"--predictions", folder_ / "rows"});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("room.txt: names scans by their position, and 6 of sequence "
                                    "room are left out"));
}

}  // namespace
}  // namespace mosbench
