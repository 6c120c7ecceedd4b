#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "eval/breakdown/reasons.hpp"
#include "eval/result/result_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

constexpr std::size_t kScansOfBreakdown = 12;

nlohmann::json breakdown(const TempFolder& folder) {
  const cli::Answer answer =
      cli::run({"breakdown", folder / "room", "--predictions", folder / "predicted", "--json"});
  if (answer.exit_code != 0) return answer.err;
  return nlohmann::json::parse(answer.out).at("sequences").at(0);
}

// The box goes 0.2 m from scan to scan.
TEST(Breakdown, TellsSpeedsByTheStampsOrAsIfAt10Hz) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", kScansOfBreakdown);
  std::filesystem::copy(folder / "room/labels", folder / "predicted");
  const nlohmann::json unstamped = breakdown(folder);
  ASSERT_EQ(unstamped.at("object_count"), 1) << unstamped;
  EXPECT_EQ(unstamped.at("speed_clock"), "10 Hz assumed");
  EXPECT_NEAR(unstamped.at("objects").at(0).at("speed_m_s").get<double>(), 2.0, 0.1);

  std::string times;
  for (std::size_t k = 0; k < kScansOfBreakdown; ++k)
    times += std::to_string(0.25 * static_cast<double>(k)) + '\n';
  folder.write("room/times.txt", times);
  const nlohmann::json stamped = breakdown(folder);
  EXPECT_EQ(stamped.at("speed_clock"), "stamps");
  EXPECT_NEAR(stamped.at("objects").at(0).at("speed_m_s").get<double>(), 0.8, 0.04);

  const cli::Answer text =
      cli::run({"breakdown", folder / "room", "--predictions", folder / "predicted"});
  EXPECT_THAT(text.out, HasSubstr("1 moving object, speeds by the scans' stamps"));
  EXPECT_THAT(text.out, HasSubstr("0.5 to 1 m/s"));
}

// Key frames of nuScenes are half a second apart: no cluster is near that of before.
TEST(Breakdown, FollowsTheObjectsOfBoxes) {
  for (const char* layout : {"nuscenes", "kitti-raw", "kitti-tracking"}) {
    const TempFolder folder;
    const std::string data = folder / "data", run = folder / "run";
    ASSERT_EQ(cli::run({"simulate", "--layout", layout, "--scene", "street", "--scans", "15",
                        "--seed", "1", "--out", data})
                  .exit_code,
              0);
    ASSERT_EQ(cli::run({"run", data, "--out", run}).exit_code, 0);
    const cli::Answer answer = cli::run({"breakdown", run, "--json"});
    ASSERT_EQ(answer.exit_code, 0) << answer.err;
    std::size_t followed = 0;
    const nlohmann::json parsed = nlohmann::json::parse(answer.out);
    for (const auto& object : parsed.at("sequences").at(0).at("objects")) {
      EXPECT_GT(object.at("instance"), 0) << layout;
      if (object.at("sightings") < 3) continue;
      if (object.at("speed_m_s").get<double>() > 4.0) ++followed;
    }
    EXPECT_GT(followed, 0U) << layout;
  }
}

TEST(Breakdown, OfAFolderOfResultsFindsDataLabelsAndRules) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", kScansOfBreakdown);
  const std::string run = folder / "run";
  ASSERT_EQ(cli::run({"run", folder / "room", "--protocol", "mapmos", "--out", run}).exit_code, 0);
  const cli::Answer told = cli::run(
      {"breakdown", folder / "room", "--predictions", run, "--protocol", "mapmos", "--json"});
  const cli::Answer found = cli::run({"breakdown", run, "--json"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_EQ(found.out, told.out);
  EXPECT_EQ(cli::run({"breakdown", run, "--sequences", "room", "--json"}).out, told.out);

  const cli::Answer twice = cli::run({"breakdown", run, "--protocol", "mapmos"});
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.err, HasSubstr("--protocol mapmos: is told by the results already"));
  const cli::Answer hall = cli::run({"breakdown", run, "--sequences", "hall"});
  EXPECT_EQ(hall.exit_code, 3);
  EXPECT_THAT(hall.err, HasSubstr("run: has no sequence hall, expected room"));
  EXPECT_THAT(cli::run({"breakdown", folder / "room"}).err, HasSubstr("--predictions: is missing"));
}

using CellOfPlace = std::array<long, 3>;

CellOfPlace cell_of_place(const Frame& frame, const Point& point) {
  const Eigen::Vector3d map_m = frame.map_from_sensor * Eigen::Vector3d(point.x, point.y, point.z);
  CellOfPlace cell{};
  for (Eigen::Index i = 0; i < 3; ++i) {
    cell.at(static_cast<std::size_t>(i)) = std::lround(std::floor(map_m[i] / kPlaceCell_m));
  }
  return cell;
}

/// When each cell of the map is first hit, by the index of the scan.
std::map<CellOfPlace, std::size_t> first_hits_of(const Sequence& sequence) {
  std::map<CellOfPlace, std::size_t> first;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    const Frame frame = sequence.read(k);
    for (const Point& point : frame.points) first.try_emplace(cell_of_place(frame, point), k);
  }
  return first;
}

TEST(Breakdown, ByReasonSaysWhichStepDecidedAndWhatHasJustComeIntoView) {
  const TempFolder folder;
  const std::string data = folder / "data", run = folder / "run";
  ASSERT_EQ(cli::run({"simulate", "--layout", "semantickitti", "--scene", "street", "--scans", "24",
                      "--seed", "3", "--out", data})
                .exit_code,
            0);
  ASSERT_EQ(cli::run({"run", data, "--preset", "best", "--perturb", "pose_noise_m=0.1,seed=1",
                      "--write", "scores", "--out", run})
                .exit_code,
            0);
  const cli::Answer answer = cli::run({"stats", run, "--by", "reason", "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const auto shown = nlohmann::json::parse(answer.out).at("sequences").at(0).at("by_reason");
  ASSERT_EQ(shown.size(), kReasonCount);

  const Result result = read_result(folder / "run/08/result.json");
  const ResultScans scans(result, std::nullopt);
  const auto first = first_hits_of(scans.sequence());
  ReasonTable expected{};
  for (const std::size_t k : scans.scored_scans()) {
    const JudgedScan scan = scans.read(k);
    for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
      ReasonCounts& counts = expected.at(static_cast<std::size_t>(scan.reasons[i]));
      if (scan.outcomes[i] == PointOutcome::kTruePositive) ++counts.tp;
      if (scan.outcomes[i] == PointOutcome::kFalseNegative) ++counts.fn;
      if (scan.outcomes[i] != PointOutcome::kFalsePositive) continue;
      ++counts.fp;
      std::size_t oldest = k;
      for (int n = 0; n < 27; ++n) {
        CellOfPlace cell = cell_of_place(scan.frame, scan.frame.points[i]);
        cell[0] += n % 3 - 1, cell[1] += n / 3 % 3 - 1, cell[2] += n / 9 - 1;
        const auto hit = first.find(cell);
        if (hit != first.end()) oldest = std::min(oldest, hit->second);
      }
      if (oldest + 10 > k) ++counts.fp_in_view;  // scans are 0.1 s apart
    }
  }
  std::uint64_t in_view = 0, stood = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const ReasonCounts& counts = expected[i];
    EXPECT_EQ(shown[i].at("tp"), counts.tp) << i;
    EXPECT_EQ(shown[i].at("fp"), counts.fp) << i;
    EXPECT_EQ(shown[i].at("fn"), counts.fn) << i;
    EXPECT_EQ(shown[i].at("fp_first_hit_within_1_s"), counts.fp_in_view) << i;
    in_view += counts.fp_in_view, stood += counts.fp - counts.fp_in_view;
  }
  EXPECT_GT(in_view, 0U);
  EXPECT_GT(stood, 0U);
  EXPECT_GT(expected[static_cast<std::size_t>(Reason::kNone)].fn, 0U);
  EXPECT_THAT(cli::run({"stats", run, "--by", "reason"}).out,
              testing::AllOf(HasSubstr("decided by"), HasSubstr("arrived"), HasSubstr("missed")));

  ASSERT_EQ(cli::run({"run", data, "--out", folder / "plain"}).exit_code, 0);
  const cli::Answer plain = cli::run({"stats", folder / "plain", "--by", "reason"});
  EXPECT_EQ(plain.exit_code, 3);
  EXPECT_THAT(plain.err, HasSubstr("a run of hmm-mos-plus with --write scores"));
  EXPECT_EQ(cli::run({"stats", data, "--predictions", run, "--by", "reason"}).exit_code, 2);
}

TEST(Stats, RefusesWhatItWouldPassOverAndReadsDataElsewhere) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", kScansOfBreakdown);
  const std::string run = folder / "run";
  ASSERT_EQ(cli::run({"run", folder / "room", "--out", run}).exit_code, 0);
  const auto refusal = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"stats", run});
    const cli::Answer answer = cli::run(words);
    EXPECT_EQ(answer.exit_code, 2) << answer.out;
    return answer.err;
  };
  EXPECT_THAT(refusal({"--protocol", "mapmos"}),
              HasSubstr("--protocol mapmos: is told by the results already, expected it with "
                        "--predictions, a data set as RUN, and --by range, height or object"));
  EXPECT_THAT(refusal({"--data", run}), HasSubstr("--data"));
  EXPECT_THAT(refusal({"--by", "scan", "--top", "3"}), HasSubstr("--top 3: does nothing here"));
  EXPECT_THAT(refusal({"--by", "range", "-o", "x.png"}), HasSubstr("-o x.png: is of a curve"));
  EXPECT_THAT(cli::run({"stats", run, "--sequences", "hall"}).err,
              HasSubstr("has no sequence hall"));
  std::filesystem::create_directories(folder / "moved");
  std::filesystem::rename(folder / "room", folder / "moved/room");
  EXPECT_EQ(cli::run({"stats", run, "--by", "range"}).exit_code, 3);
  EXPECT_EQ(cli::run({"stats", run, "--by", "range", "--data", folder / "moved"}).exit_code, 0);
  EXPECT_EQ(cli::run({"stats", run, "--sequences", "room"}).exit_code, 0);
}

}  // namespace
}  // namespace mosbench
