#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "eval/breakdown/object_tracks.hpp"

namespace mosbench {
namespace {

/// Points on the outline of a box of 4 x 2 x 1 m, turned and put somewhere.
std::vector<Eigen::Vector3d> outline(double yaw_rad, const Eigen::Vector3d& centre_m) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::vector<Eigen::Vector3d> points;
  for (double along = -2.0; along <= 2.0; along += 0.25) {
    for (const double across : {-1.0, 1.0}) {
      for (const double up : {-0.5, 0.0, 0.5}) {
        points.push_back(centre_m + turn * Eigen::Vector3d(along, across, up));
      }
    }
  }
  for (double across = -1.0; across <= 1.0; across += 0.25) {
    points.push_back(centre_m + turn * Eigen::Vector3d(2.0, across, 0.0));
    points.push_back(centre_m + turn * Eigen::Vector3d(-2.0, across, 0.0));
  }
  return points;
}

double yaw_of(const MovingBox& box) {
  const Eigen::Vector3d x = box.map_from_box.linear().col(0);
  return std::atan2(x.y(), x.x());
}

/// Scans a tenth of a second apart, without stamps.
class FewScans : public Sequence {
 public:
  explicit FewScans(std::size_t scans) { mutable_recording().scans.resize(scans); }
  using Sequence::read;
  void read(std::size_t, Frame&) const override {}
  std::vector<std::uint32_t> read_truth(std::size_t) const override { return {}; }
};

TEST(SmallestBox, FindsTheSidesOfATurnedOutline) {
  for (const double degrees : {0.0, 20.0, 60.0, 88.0}) {
    const MovingBox box = smallest_box(outline(degrees * std::numbers::pi / 180.0, {7, -3, 1}));
    EXPECT_NEAR(std::max(box.size_m.x(), box.size_m.y()), 4.0, 1e-9) << degrees;
    EXPECT_NEAR(std::min(box.size_m.x(), box.size_m.y()), 2.0, 1e-9) << degrees;
    EXPECT_NEAR(box.size_m.z(), 1.0, 1e-9);
    EXPECT_TRUE(box.map_from_box.translation().isApprox(Eigen::Vector3d(7, -3, 1), 1e-9));
    EXPECT_EQ(box.points, outline(0, {0, 0, 0}).size());
  }
}

TEST(MovingBoxes, FaceTheWayTheyGoAndKeepTheirNumber) {
  const double yaw_rad = -150.0 * std::numbers::pi / 180.0;
  const Eigen::Vector3d step_m =
      0.8 * Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);  // 8 m/s
  const FewScans sequence(20);
  const auto points = [&](std::size_t k) {
    std::vector<Eigen::Vector3d> all = outline(yaw_rad, static_cast<double>(k) * step_m);
    for (const auto& point : outline(0.0, {30, 30, 0})) all.push_back(point);
    all.emplace_back(-50.0, 0.0, 0.0);  // alone
    return all;
  };
  const std::vector<std::size_t> scans = {3, 4, 5, 6, 7, 8, 9, 10};
  const auto boxes = moving_boxes(sequence, scans, points, 1);
  ASSERT_EQ(boxes.size(), scans.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    ASSERT_EQ(boxes[i].size(), 2U);
    const bool first_goes = boxes[i][0].map_from_box.translation().x() < 20.0;
    const MovingBox& going = boxes[i][first_goes ? 0 : 1];
    const MovingBox& standing = boxes[i][first_goes ? 1 : 0];
    EXPECT_EQ(going.track, boxes[0][first_goes ? 0 : 1].track);
    EXPECT_NE(going.track, standing.track);
    ASSERT_TRUE(going.velocity_m_s);
    EXPECT_TRUE(going.velocity_m_s->isApprox(10.0 * step_m, 1e-9)) << *going.velocity_m_s;
    EXPECT_NEAR(yaw_of(going), yaw_rad, 1e-9);
    EXPECT_NEAR(going.size_m.x(), 4.0, 1e-9);
    EXPECT_NEAR(standing.velocity_m_s->norm(), 0.0, 1e-9);
  }
  EXPECT_EQ(moving_boxes(sequence, scans, points, 3)[2][0].map_from_box.matrix(),
            boxes[2][0].map_from_box.matrix());
}

TEST(MovingBoxes, OfAnObjectThatIsSeenOnceHaveNoSpeed) {
  const FewScans sequence(1);
  const auto points = [](std::size_t) { return outline(0.0, {0, 0, 0}); };
  const auto boxes = moving_boxes(sequence, {0}, points, 1);
  ASSERT_EQ(boxes.at(0).size(), 1U);
  EXPECT_FALSE(boxes[0][0].velocity_m_s);
  EXPECT_EQ(boxes[0][0].track, 1U);
}

}  // namespace
}  // namespace mosbench
