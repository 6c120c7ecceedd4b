#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

/// A drive by something that drives ahead, with a hood that the sensor sees.
class EgoCommands : public testing::Test {
 protected:
  void SetUp() override {
    std::vector<Pose> poses;
    for (int k = 0; k < kScansOfEgo; ++k) {
      const double x = 0.7 * k;
      poses.push_back(pose_at({x, 0, 0}, 0));
      std::vector<SceneBox> boxes = street();
      boxes.push_back({{x + 1.2, -0.8, -0.6}, {x + 2.6, 0.8, -0.3}});
      const double ahead = 12 + 1.4 * k;
      boxes.push_back({{ahead, -1, -1.7}, {ahead + 2, 1, 0.2}});
      const std::vector<Point> points = scene_points(boxes, poses.back(), k);
      const std::string stem = std::to_string(100000 + k);
      write_bin(folder_ / ("s/velodyne/" + stem + ".bin"), points);
      std::vector<std::uint32_t> truth;
      for (const Point& p : points) {
        const bool moves =
            p.x > ahead - x - 0.1 && p.x < ahead - x + 2.1 && std::abs(p.y) < 1.1 && p.z > -1.75;
        truth.push_back(moves ? 251U : 9U);
        hood_points_ += is_hood(p);
      }
      write_labels(folder_ / ("s/labels/" + stem + ".label"), truth);
    }
    write_poses(folder_ / "s/poses.txt", poses);
    ASSERT_GT(hood_points_, 1000U);
  }
  static bool is_hood(const Point& p) {
    return p.x > 1.1 && p.x < 2.7 && std::abs(p.y) < 0.85 && p.z > -0.65 && p.z < -0.25;
  }
  std::string path(const char* name) const { return (folder_ / name).string(); }
  cli::Answer run(const char* data, const char* out, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", path(data), "--preset", "semantickitti", "--out", path(out)});
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
};

TEST_F(EgoCommands, SayThatTheVehicleIsSeenAndLeaveItOutWhereTold) {
  EXPECT_THAT(cli::run({"doctor", path("s")}).out,
              AllOf(HasSubstr("points per scan of the vehicle itself, within 2."),
                    HasSubstr("--read drop_ego=auto leaves them out")));
  EXPECT_THAT(cli::run({"doctor", path("s"), "--read", "drop_ego=auto"}).out,
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
    const std::vector<Point> points = read_bin(folder_ / ("s/velodyne/" + stem + ".bin"));
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

}  // namespace
}  // namespace mosbench
