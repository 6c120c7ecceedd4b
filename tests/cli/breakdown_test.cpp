#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "eval/breakdown/error_scenes.hpp"
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

TEST(Breakdown, ByReasonSaysWhichStepDecidedAndWhatLiesAround) {
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
  EXPECT_EQ(cli::run({"stats", run, "--by", "reason", "--json", "--threads", "1"}).out, answer.out);

  const Result result = read_result(folder / "run/08/result.json");
  const ResultScans scans(result, std::nullopt);
  constexpr std::array kSteps = {"missed", "arrived", "departed", "grown", "feet", "predicted"};
  // By step: tp, fp and fn, then wrong points by scene.
  std::map<std::string, std::vector<int>> expected, shown;
  for (std::size_t k = 0; k < 24; ++k) {
    const JudgedScan scan = scans.read(k);
    std::optional<Frame> earlier;
    if (k >= 10) earlier = scans.sequence().read(k - 10);  // scans are 0.1 s apart
    const std::vector<ErrorScene> scenes =
        error_scenes(scan, earlier ? &*earlier : nullptr, scan.frame.truth.value());
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      const auto outcome = static_cast<std::size_t>(scan.outcomes[i]);
      if (outcome > 2) continue;  // right and static, or not judged
      auto& row = expected[kSteps.at(static_cast<std::size_t>(scan.reasons[i]))];
      row.resize(2 + kErrorSceneNames.size());
      ++row[outcome];
      if (outcome > 0) ++row[2 + static_cast<std::size_t>(scenes[i])];
    }
  }
  const nlohmann::json parsed = nlohmann::json::parse(answer.out);
  for (const nlohmann::json& row : parsed.at("sequences").at(0).at("by_reason")) {
    auto& counts = shown[row.at("reason")];
    for (const char* outcome : {"tp", "fp", "fn"}) counts.push_back(row.at(outcome));
    for (std::size_t s = 1; s < kErrorSceneNames.size(); ++s) {
      counts.push_back(row.at("scenes").at(kErrorSceneNames.at(s)));
    }
  }
  EXPECT_EQ(shown, expected);
  EXPECT_GT(expected.at("missed").at(4), 0) << "first sight";
  EXPECT_GT(expected.at("arrived").at(5), 0) << "poses";
  EXPECT_THAT(cli::run({"stats", run, "--by", "reason"}).out,
              testing::AllOf(HasSubstr("decided by"), HasSubstr("arrived"), HasSubstr("missed"),
                             HasSubstr("vegetation")));
  EXPECT_EQ(cli::run({"stats", data, "--predictions", run, "--by", "reason"}).exit_code, 2);
}

TEST(Breakdown, ByReasonHasOneRowOfWhatAMethodMovesThatSaysNone) {
  const TempFolder folder;
  cli::write_small_sequence(folder / "room", kScansOfBreakdown);
  const std::string run = folder / "run";
  ASSERT_EQ(cli::run({"run", folder / "room", "--protocol", "mapmos", "--out", run}).exit_code, 0);
  const cli::Answer answer = cli::run({"stats", run, "--by", "reason", "--as", "csv"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  EXPECT_THAT(answer.out, HasSubstr("decided_by,right,wrong,near_moving,first_sight,poses,"));
  EXPECT_THAT(answer.out, HasSubstr("\ncalled moving,"));
  EXPECT_THAT(answer.out, HasSubstr("\nmissed,0,"));
  EXPECT_THAT(answer.out, testing::Not(HasSubstr("arrived")));
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
