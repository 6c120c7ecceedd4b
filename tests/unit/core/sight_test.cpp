#include "core/tracks/sight.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/tracks/looks.hpp"
#include "core/tracks/low_points.hpp"

namespace mosbench::tracks {
namespace {

/// A wall at x = 10 m, 4 m wide and high, of points 5 cm apart.
std::vector<Point> wall_of_points() {
  std::vector<Point> points;
  for (int y = -40; y <= 40; ++y) {
    for (int z = -40; z <= 40; ++z) {
      points.push_back({10, 0.05F * static_cast<float>(y), 0.05F * static_cast<float>(z), 0});
    }
  }
  return points;
}

TEST(Sight, TellsThroughHitAndHiddenApart) {
  const SightImage image(wall_of_points(), 0.5);
  EXPECT_EQ(image.at({5, 0, 0}), Sight::kThrough);
  EXPECT_EQ(image.at({9.7F, 0, 0}), Sight::kHidden) << "a ray that went on by 0.3 m may be noise";
  EXPECT_EQ(image.at({9.9F, 0.1F, 0.1F}), Sight::kHit);
  EXPECT_EQ(image.at({10.1F, 0, 0}), Sight::kHit);
  EXPECT_EQ(image.at({12, 0, 0}), Sight::kHidden);
  EXPECT_EQ(image.at({0, 10, 0}), Sight::kHidden) << "no ray went there";
  EXPECT_EQ(image.at({5, 0, 5}), Sight::kHidden) << "nor there";
}

TEST(Sight, GoesNotThroughBesideWhatIsNearer) {
  const std::vector<Point> points = {{8, 0.01F, 0.01F, 0}, {20, 0.2F, 0.01F, 0}};
  const SightImage image(points, 0.5);
  EXPECT_EQ(image.at({12, 0.1F, 0}), Sight::kHit) << "it may be a surface between the two";
  EXPECT_EQ(image.at({12, 0.2F, 0}), Sight::kThrough);
}

TEST(Sight, LeavesOutWhatIsNearOrNoNumber) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<Point> points = {{0.4F, 0, 0, 0}, {nan, 0, 0, 0}, {inf, 0, 0, 0}, {8, 0, 0, 0}};
  EXPECT_EQ(SightImage(points, 0.5).at({4, 0, 0}), Sight::kThrough);
  EXPECT_EQ(SightImage({}, 0.5).at({4, 0, 0}), Sight::kHidden);
  EXPECT_EQ(SightImage(points, 0.5).at({nan, 0, 0}), Sight::kHidden);
}

TEST(Sight, GoesAllAround) {
  for (int degrees = -180; degrees < 180; ++degrees) {
    const float turn = static_cast<float>(degrees) * 3.14159265F / 180;
    const Eigen::Vector3f far(20 * std::cos(turn), 20 * std::sin(turn), 1);
    const std::vector<Point> points = {{far.x(), far.y(), far.z(), 0}};
    EXPECT_EQ(SightImage(points, 0.5).at(0.5F * far), Sight::kThrough) << degrees;
    EXPECT_EQ(SightImage(points, 0.5).at(far), Sight::kHit) << degrees;
  }
}

TEST(SightImage, LooksFromEachPlaceThatRaysStartAt) {
  // The left sensor sees a wall, the right one a board before it.
  const std::vector<Point> points = {{10, -1, 0, 0}, {5, 1, 0, 0}};
  const SightImage rig(points, 0.5, {{{0, -1, 0}, {0, 1, 0}}, {0, 1}});
  EXPECT_EQ(rig.at({5, -1, 0}), Sight::kThrough);
  EXPECT_EQ(rig.at({5, 1, 0}), Sight::kHit);
  EXPECT_EQ(rig.at({8, 1, 0}), Sight::kHidden);
  EXPECT_TRUE(rig.repeats({10, -1, 0}));
  EXPECT_FALSE(rig.repeats({5, -1, 0}));
  EXPECT_EQ(SightImage(points, 0.5).at({8, -0.8F, 0}), Sight::kThrough) << "from one place";
  EXPECT_EQ(rig.at({8, -0.8F, 0}), Sight::kHidden);
}

TEST(SightImage, LooksFromTwoOriginsAtOnePlaceAsFromOne) {
  // What one of them alone sees through, both together hit: a surface may be between.
  const std::vector<Point> points = {{3, 0, 0, 0}, {10, 0, 0, 0}};
  const SightImage rig(points, 0.5, {{{0, 0, 0}, {0, 0, 0}}, {0, 1}});
  EXPECT_EQ(SightImage(points, 0.5).at({5, 0, 0}), Sight::kHit);
  EXPECT_EQ(rig.at({5, 0, 0}), Sight::kHit);
}

TEST(Looks, CountWhatWasSeenThroughAndHitBeforeAndAfter) {
  const SightImage image(wall_of_points(), 0.5);
  Look before{&image, Eigen::Isometry3f::Identity(), true}, after = before, nearer = before;
  after.before = false;
  nearer.there_from_here.translation().x() = 5;
  const Evidence evidence = evidence_of({5, 0, 0}, std::vector{before, after, after, nearer});
  EXPECT_EQ(evidence.through_before, 1);
  EXPECT_EQ(evidence.through_after, 2);
  EXPECT_EQ(evidence.hit_before, 1);
  EXPECT_EQ(evidence.hit_after, 0);
}

TEST(Looks, KnowWhatTheSensorCarries) {
  std::vector<Point> points = {{2, 0, -0.5F, 0}, {10, 0, 0, 0}};
  const SightImage image(points, 0.5);
  Look moved{&image, Eigen::Isometry3f::Identity(), true}, still = moved;
  moved.there_from_here.translation().x() = -2;
  EXPECT_TRUE(is_carrier({2, 0, -0.5F}, std::vector{moved, still}));
  EXPECT_FALSE(is_carrier({2, 0, -0.5F}, std::vector{still})) << "everything stays in place there";
  EXPECT_FALSE(is_carrier({10, 0, 0}, std::vector{moved})) << "a car ahead at the same speed";
  EXPECT_FALSE(is_carrier({1.5F, 0, -0.5F}, std::vector{moved}));
}

TEST(LowPoints, LieOnTheGroundOfTheirNeighbourhood) {
  const std::vector<Eigen::Vector3f> positions = {
      {0.5F, 0.5F, 0}, {0.5F, 0.5F, 0.19F}, {0.5F, 0.5F, 0.3F}, {1.5F, 0.5F, 0.15F},
      {5.5F, 0.5F, 1}, {5.5F, 0.5F, 1.3F},  {5.5F, 0.5F, 0}};
  EXPECT_EQ(low_points(positions, std::vector<std::uint8_t>{1, 1, 1, 1, 1, 1, 0}),
            (std::vector<std::uint8_t>{1, 1, 0, 1, 1, 0, 0}));
}

}  // namespace
}  // namespace mosbench::tracks
