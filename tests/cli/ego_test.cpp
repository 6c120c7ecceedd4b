#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "tests/cli/program.hpp"
#include "tests/odometry_scenes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kScansOfEgo = 24;

/// A drive behind something that drives ahead, with a hood that the sensor sees. The points have
/// times.
class EgoCommands : public testing::Test {
 protected:
  void SetUp() override {
    for (int k = 0; k < kScansOfEgo; ++k) {
      const double x = 0.7 * k, ahead = 12 + 1.4 * k;
      std::vector<SceneBox> boxes = street();
      boxes.push_back({{x + 1.2, -0.8, -0.6}, {x + 2.6, 0.8, -0.3}});
      boxes.push_back({{ahead, -1, -1.7}, {ahead + 2, 1, 0.2}});
      const Pose pose = pose_at({x, 0, 0}, 0);
      SceneScan scan = scene_scan(boxes, pose, {.seed = static_cast<unsigned>(k) + 1});
      add(scan, pose, 0.1 * k, [&](const Point& p) {
        return p.x > ahead - x - 0.1 && p.x < ahead - x + 2.1 && std::abs(p.y) < 1.1 && p.z > -1.75;
      });
    }
    ASSERT_GT(hood_points_, 1000U);
  }
  /// Adds a scan after those that there are.
  void add(const SceneScan& scan, const Pose& pose, double time_s,
           const std::function<bool(const Point&)>& moves) {
    const std::string stem = std::to_string(100000 + poses_.size());
    std::string rows;
    std::vector<std::uint32_t> truth;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Point& p = scan.points[i];
      const float row[] = {p.x, p.y, p.z, p.intensity,
                           1e-9F * static_cast<float>(scan.point_times_ns[i])};
      rows.append(reinterpret_cast<const char*>(row), sizeof(row));
      truth.push_back(moves(p) ? 251U : 9U);
      hood_points_ += is_hood(p);
    }
    folder_.write("s/velodyne/" + stem + ".bin", rows);
    write_labels(folder_ / ("s/labels/" + stem + ".label"), truth);
    poses_.push_back(pose);
    times_ += fmt::format("{:.3f}\n", 1000 + time_s);
    write_poses(folder_ / "s/poses.txt", poses_);
    folder_.write("s/times.txt", times_);
    last_ = scan;
  }
  static bool is_hood(const Point& p) {
    return p.x > 1.1 && p.x < 2.7 && std::abs(p.y) < 0.85 && p.z > -0.65 && p.z < -0.25;
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  cli::Answer run(const char* data, const char* out, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", path(data), "--preset", "semantickitti", "--out", path(out)});
    if (data == std::string("s")) more.insert(more.end(), {"--read", "bin_columns=5"});
    return cli::run(more);
  }
  /// Bytes of the labels of all scans, in order.
  std::vector<std::string> labels(const char* out) const {
    std::vector<std::string> all;
    for (const auto& [name, bytes] : cli::contents(folder_ / out)) {
      if (name.ends_with(".label")) all.push_back(bytes);
    }
    return all;
  }

  TempFolder folder_;
  std::size_t hood_points_ = 0;
  std::vector<Pose> poses_;
  std::string times_;
  SceneScan last_;
};

TEST_F(EgoCommands, SayThatTheVehicleIsSeenAndLeaveItOutWhereTold) {
  EXPECT_THAT(cli::run({"doctor", path("s"), "--read", "bin_columns=5"}).out,
              AllOf(HasSubstr("points per scan of the vehicle itself, within 2."),
                    HasSubstr("--read drop_ego=auto leaves them out")));
  EXPECT_THAT(cli::run({"doctor", path("s"), "--read", "bin_columns=5,drop_ego=auto"}).out,
              AllOf(HasSubstr("left out: "), Not(HasSubstr("leaves them out"))));
  const cli::Answer plain = run("s", "plain");
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_THAT(plain.out, Not(HasSubstr("vehicle itself")));
  const cli::Answer left = run("s", "left", {"--read", "drop_ego=auto"});
  ASSERT_EQ(left.exit_code, 0) << left.err;
  EXPECT_THAT(left.out, HasSubstr("left out: "));
  ASSERT_EQ(labels("left").size(), static_cast<std::size_t>(kScansOfEgo));
  for (int k = 0; k < kScansOfEgo; ++k) {
    const std::string stem = std::to_string(100000 + k);
    const std::vector<Point> points = read_bin(folder_ / ("s/velodyne/" + stem + ".bin"), 5);
    const auto moving = read_labels(folder_ / ("left/s/labels/" + stem + ".label"), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_FALSE(is_hood(points[i]) && moving[i] == 251U) << k;
    }
  }
  const cli::Answer mixed = run("s", "plain", {"--read", "drop_ego=auto"});
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_THAT(mixed.err, HasSubstr("drop_ego"));
  const cli::Answer wrong = run("s", "o", {"--read", "drop_ego=on"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("off or auto"));
}

TEST_F(EgoCommands, ConvertWritesWhatIsMendedSoThatItsLabelsAreTheSame) {
  const auto nothing_moves = [](const Point&) { return false; };
  const auto scans = static_cast<std::size_t>(kScansOfEgo);
  add(last_, poses_.back(), 0.1 * kScansOfEgo - 0.05, nothing_moves);
  add({}, poses_.back(), 0.1 * kScansOfEgo, nothing_moves);
  EXPECT_THAT(cli::run({"doctor", path("s"), "--read", "bin_columns=5"}).out,
              AllOf(HasSubstr("100024 as 100023"), HasSubstr("drop_scans=auto")));
  const std::vector<std::string> mended = {"--point-times", "column", "--read",
                                           "bin_columns=5,drop_ego=auto,drop_scans=auto"};
  const auto original = cli::contents(folder_ / "s");
  const cli::Answer read = run("s", "out", mended);
  ASSERT_EQ(read.exit_code, 0) << read.err;
  ASSERT_EQ(labels("out").size(), scans);

  std::vector<std::string> check = {"convert", path("s"), "--check"};
  check.insert(check.end(), mended.begin(), mended.end());
  const cli::Answer plan = cli::run(check);
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  for (const char* line : {"scans on disk +26", "drop_scans +1 empty, 1 repeated", "deskew +poses",
                           "drop_ego +[0-9]+ points per scan", "scans written +24"}) {
    EXPECT_THAT(plan.out, testing::ContainsRegex(line));
  }
  for (const char* layout : {"semantickitti", "sipailou", "ros2-mcap", "ros2-db3"}) {
    std::vector<std::string> convert = {"convert", path("s"), "--layout",
                                        layout,    "--out",   path(layout)};
    convert.insert(convert.end(), mended.begin(), mended.end());
    const cli::Answer converted = cli::run(convert);
    ASSERT_EQ(converted.exit_code, 0) << converted.err;
    EXPECT_THAT(converted.out, HasSubstr("converted 24 scans"));
    const std::string out = layout + std::string("_out");
    const cli::Answer again = run(layout, out.c_str());
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(labels(out.c_str()), labels("out")) << layout;
    EXPECT_THAT(cli::run({"doctor", path(layout)}).out,
                AllOf(Not(HasSubstr("drop_ego")), Not(HasSubstr("drop_scans"))))
        << layout;
  }
  EXPECT_EQ(cli::contents(folder_ / "s"), original);
  const cli::Answer found =
      cli::run({"convert", path("s"), "--check", "--odometry", "kiss", "--read", "bin_columns=5"});
  EXPECT_THAT(found.out, AllOf(HasSubstr("odometry kiss"), Not(HasSubstr("poses are equal"))));
  const cli::Answer neither = cli::run({"convert", path("s"), "--layout", "doals"});
  EXPECT_EQ(neither.exit_code, 2);
  EXPECT_THAT(neither.err, HasSubstr("expected them, or --check"));
}

}  // namespace
}  // namespace mosbench
