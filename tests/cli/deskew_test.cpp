#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/odometry_scenes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;
using testing::HasSubstr;

constexpr int kScansOfDeskew = 10;

double way_m(int k) { return 0.075 * k * k; }

/// A drive that speeds up through a street, in .bin files with the time of each point.
class SkewedDrive : public testing::Test {
 protected:
  void SetUp() override {
    std::vector<Pose> truth;
    std::string times;
    for (int k = 0; k < kScansOfDeskew; ++k) {
      truth.push_back(pose_at({way_m(k), 0, 0}, 0));
      const SceneScan scan = scene_scan(
          street(), truth.back(),
          {.motion_m = {way_m(k + 1) - way_m(k), 0, 0}, .seed = static_cast<unsigned>(k)});
      ASSERT_GT(scan.points.size(), 5000u);
      std::string bytes;
      for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Point& p = scan.points[i];
        const float time_s = 1e-9F * static_cast<float>(scan.point_times_ns[i]);
        const float row[] = {p.x, p.y, p.z, p.intensity, time_s};
        bytes.append(reinterpret_cast<const char*>(row), sizeof(row));
      }
      folder_.write("s/velodyne/00000" + std::to_string(k) + ".bin", bytes);
      times += std::to_string(0.1 * k) + "\n";
    }
    folder_.write("s/times.txt", times);
    write_poses(folder_ / "truth.txt", truth);
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  /// The largest error of the positions that odometry finds, metres.
  double error_m(const char* kind, const char* deskew) const {
    const cli::Answer found = cli::run({"odometry", path("s"), "-o", path("found.txt"),
                                        "--odometry", kind, "--bin-columns", "5", "--point-times",
                                        "column", "--deskew", deskew, "--overwrite"});
    EXPECT_LE(found.exit_code, 1) << found.err;
    const cli::Answer score =
        cli::run({"trajectory", path("found.txt"), "--truth", path("truth.txt"), "--json"});
    const ordered_json json = ordered_json::parse(score.out);
    return json.at("sequences")[0].at("absolute").at("translation_m").at("max");
  }

  TempFolder folder_;
};

TEST_F(SkewedDrive, IsFollowedBetterWhenItIsDeskewed) {
  for (const char* kind : {"simple", "kiss"}) {
    const double none_m = error_m(kind, "none");
    EXPECT_GT(none_m, 0.15) << kind;
    EXPECT_LT(error_m(kind, "velocity"), 0.7 * none_m) << kind;
    EXPECT_LT(error_m(kind, "poses"), 0.7 * none_m) << kind;
  }
}

TEST_F(SkewedDrive, IsConvertedWithItsPointsWhereTheStampSawThem) {
  const std::vector<std::string> command = {
      "convert",  path("s"), "--poses", path("truth.txt"), "--bin-columns", "5",
      "--layout", "doals",   "--out",   path("moved"),     "--point-times", "column"};
  ASSERT_EQ(cli::run(command).exit_code, 0);
  std::vector<std::string> raw = command;
  raw[9] = path("raw");
  raw.push_back("--raw-scans");
  ASSERT_EQ(cli::run(raw).exit_code, 0);
  const auto moved = cli::contents(folder_ / "moved"), stored = cli::contents(folder_ / "raw");
  ASSERT_EQ(moved.size(), stored.size());
  std::size_t scans = 0, other = 0;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (!moved[i].first.ends_with(".bin")) continue;
    ++scans;
    if (moved[i].second != stored[i].second) ++other;
  }
  EXPECT_EQ(scans, static_cast<std::size_t>(kScansOfDeskew));
  EXPECT_EQ(other, scans - 1);  // no pose follows the last one
}

TEST_F(SkewedDrive, IsRefusedWithTimesThatItDoesNotHave) {
  const cli::Answer four = cli::run({"odometry", path("s"), "-o", path("found.txt"),
                                     "--point-times", "column", "--bin-columns", "4"});
  EXPECT_EQ(four.exit_code, 3);
  const cli::Answer other = cli::run({"odometry", path("s"), "-o", path("found.txt"),
                                      "--bin-columns", "5", "--point-times", "ring"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("--point-times"));
}

}  // namespace
}  // namespace mosbench
