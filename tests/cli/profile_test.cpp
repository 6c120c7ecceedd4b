#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string_view>

#include "tests/cli/program.hpp"
#include "tests/cli/small_sequence.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kStageNames[] = {"voxelize",       "raycast", "map_update", "evict",
                                            "convolution",    "median",  "window",     "otsu",
                                            "dynamic_region", "labels"};

using testing::HasSubstr;

constexpr std::size_t kScansProfiled = 12;

/// Profiles a small sequence once; the files are in `folder`.
cli::Answer profile_small(const TempFolder& folder, const std::vector<std::string>& more = {}) {
  cli::write_small_sequence(folder.path() / "room", kScansProfiled);
  std::vector<std::string> arguments = {"profile",   (folder.path() / "room").string(),
                                        "--threads", "1",
                                        "--json",    (folder.path() / "profile.json").string(),
                                        "--out",     (folder.path() / "trace.json").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return cli::run(arguments);
}

TEST(Profile, ShowsEveryStageMemoryAndSpeed) {
  const TempFolder folder;
  const cli::Answer answer = profile_small(folder);
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  for (const std::string_view stage : kStageNames) {
    EXPECT_THAT(answer.out, HasSubstr(std::string(1, '\n').append(stage).append(1, ' ')));
  }
  EXPECT_THAT(answer.out, HasSubstr("resident MiB"));
  EXPECT_THAT(answer.out, HasSubstr("times real time"));
}

TEST(Profile, StagesAddUpToTheMethodAndSpreadsAreInOrder) {
  const TempFolder folder;
  ASSERT_EQ(profile_small(folder).exit_code, 0);
  const nlohmann::json whole = nlohmann::json::parse(read_file(folder.path() / "profile.json"));
  const nlohmann::json& sequence = whole["sequences"][0];
  ASSERT_EQ(sequence["scans"].size(), kScansProfiled);
  for (const char* clock : {"wall_ms", "cpu_ms"}) {
    double sum_ms = 0;
    for (const auto& [name, cost] : sequence["stages"].items()) {
      const nlohmann::json& spread = cost[clock];
      EXPECT_LE(spread["min"], spread["median"]) << name;
      EXPECT_LE(spread["median"], spread["p95"]) << name;
      EXPECT_LE(spread["p95"], spread["max"]) << name;
      if (name != "read" && name != "method") sum_ms += spread["mean"].get<double>();
    }
    const double method_ms = sequence["stages"]["method"][clock]["mean"];
    EXPECT_NEAR(sum_ms, method_ms, 0.05 * method_ms) << clock;
    // Not of wall time, in which others run.
    const double between_ms = sequence["stages"]["between stages"]["cpu_ms"]["min"];
    EXPECT_LT(between_ms, 0.5 * sequence["stages"]["method"]["cpu_ms"]["mean"].get<double>());
  }
  for (const nlohmann::json& scan : sequence["scans"]) {
    EXPECT_EQ(scan["points"], cli::kPointsPerScan);
    EXPECT_GT(scan["map_blocks"], 0);
    EXPECT_GT(scan["resident_mib"], 0.0);
  }
}

TEST(Profile, TraceHoldsEachStageInsideItsScan) {
  const TempFolder folder;
  ASSERT_EQ(profile_small(folder).exit_code, 0);
  const nlohmann::json trace = nlohmann::json::parse(read_file(folder.path() / "trace.json"));
  double scan_start_us = 0, scan_end_us = 0;
  std::size_t scans = 0, counters = 0;
  std::map<std::string, std::size_t> slices;
  for (const nlohmann::json& event : trace["traceEvents"]) {
    counters += event["ph"] == "C";
    if (event["ph"] != "X") continue;
    const double start_us = event["ts"], end_us = start_us + event["dur"].get<double>();
    if (event["name"].get<std::string>().starts_with("scan ")) {
      EXPECT_GE(start_us + 0.1, scan_end_us);
      scan_start_us = start_us;
      scan_end_us = end_us;
      ++scans;
    } else {
      EXPECT_GE(start_us, scan_start_us) << event["name"];
      EXPECT_LE(end_us, scan_end_us + 0.1) << event["name"];  // up to rounding
      ++slices[event["name"]];
    }
  }
  EXPECT_EQ(scans, kScansProfiled);
  EXPECT_EQ(slices["read"], kScansProfiled);
  // Detection starts when the window is full.
  const std::set<std::string_view> always = {"voxelize", "raycast", "map_update", "evict"};
  for (const std::string_view stage : kStageNames) {
    EXPECT_EQ(slices[std::string(stage)],
              always.contains(stage) ? kScansProfiled : kScansProfiled - 4)
        << stage;
  }
  EXPECT_EQ(counters, 2 * kScansProfiled);
}

TEST(Profile, StopsAfterTheScansAskedFor) {
  const TempFolder folder;
  ASSERT_EQ(profile_small(folder, {"--scans", "5"}).exit_code, 0);
  const nlohmann::json whole = nlohmann::json::parse(read_file(folder.path() / "profile.json"));
  EXPECT_EQ(whole["sequences"][0]["scans"].size(), 5U);
}

TEST(Profile, RefusesWhatRunRefuses) {
  EXPECT_EQ(cli::run({"profile"}).exit_code, 2);
  EXPECT_EQ(cli::run({"profile", "x", "--scans", "0"}).exit_code, 2);
  const TempFolder folder;
  const cli::Answer absent = cli::run({"profile", (folder.path() / "absent").string()});
  EXPECT_EQ(absent.exit_code, 3);
  EXPECT_THAT(absent.err, HasSubstr("absent"));
  cli::write_small_sequence(folder.path() / "room", 1);
  const cli::Answer unwritable =
      cli::run({"profile", (folder.path() / "room").string(), "--json",
                (folder.path() / "room/poses.txt/profile.json").string()});
  EXPECT_EQ(unwritable.exit_code, 3);
  EXPECT_THAT(unwritable.err, HasSubstr("profile.json"));
}

TEST(Profile, NamesTheFileOfAScanThatIsOutOfReach) {
  const TempFolder folder;
  cli::write_small_sequence(folder.path() / "room", kScansProfiled);
  std::vector<Pose> poses(kScansProfiled, Pose::Identity());
  poses[7].translation().x() = 9e6;
  write_poses(folder.path() / "room/poses.txt", poses);
  const cli::Answer answer = cli::run({"profile", (folder.path() / "room").string()});
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.err, HasSubstr("room/velodyne/000007.bin: "));
}

}  // namespace
}  // namespace mosbench
