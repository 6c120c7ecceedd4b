#include "datasets/simulator/sensor_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

constexpr double kDegPerRad = 57.29577951308232;

struct View {
  double lowest_deg = 1e9, highest_deg = -1e9, leftmost_deg = -1e9, rightmost_deg = 1e9;
};

View view_of(const std::vector<Eigen::Vector3d>& rays) {
  View view;
  for (const Eigen::Vector3d& ray : rays) {
    const double elevation_deg = kDegPerRad * std::asin(ray.z());
    const double azimuth_deg = kDegPerRad * std::atan2(ray.y(), ray.x());
    view.lowest_deg = std::min(view.lowest_deg, elevation_deg);
    view.highest_deg = std::max(view.highest_deg, elevation_deg);
    view.leftmost_deg = std::max(view.leftmost_deg, azimuth_deg);
    view.rightmost_deg = std::min(view.rightmost_deg, azimuth_deg);
  }
  return view;
}

TEST(SensorModel, HasAsManySlotsAsTheRealSensor) {
  EXPECT_EQ(sensor_model(SensorKind::kOs1_64).slots(), 131072U);
  EXPECT_EQ(sensor_model(SensorKind::kOs2_128).slots(), 131072U);
  EXPECT_EQ(sensor_model(SensorKind::kVlp16).slots(), 28800U);
  EXPECT_EQ(sensor_model(SensorKind::kAvia).slots(), 24000U);
  EXPECT_EQ(sensor_model(SensorKind::kMid360).slots(), 20000U);
  for (const std::string_view name : sensor_names()) {
    const SensorModel sensor = sensor_model(*sensor_kind_from_string(name));
    EXPECT_EQ(beam_directions(sensor, 0).size(), sensor.slots()) << name;
    EXPECT_EQ(to_string(sensor.kind), name);
  }
  EXPECT_FALSE(sensor_kind_from_string("os1"));
}

TEST(SensorModel, FiresInUnitDirections) {
  for (const std::string_view name : sensor_names()) {
    for (const auto& ray : beam_directions(sensor_model(*sensor_kind_from_string(name)), 3)) {
      ASSERT_NEAR(ray.norm(), 1.0, 1e-12) << name;
    }
  }
}

TEST(SensorModel, SeesTheFieldOfViewOfItsDataSheet) {
  const View ouster = view_of(beam_directions(sensor_model(SensorKind::kOs1_64), 0));
  EXPECT_NEAR(ouster.highest_deg - ouster.lowest_deg, 33.22, 1e-9);
  EXPECT_NEAR(ouster.leftmost_deg - ouster.rightmost_deg, 360.0 * 2047 / 2048, 1e-9);
  const View aeva = view_of(beam_directions(sensor_model(SensorKind::kAeva), 0));
  EXPECT_NEAR(aeva.highest_deg - aeva.lowest_deg, 19.2, 1e-9);
  EXPECT_NEAR(aeva.leftmost_deg, 60.0, 0.1);
  const View kitti = view_of(beam_directions(sensor_model(SensorKind::kHdl64e), 0));
  EXPECT_NEAR(kitti.highest_deg, 2.0, 1e-9);
  EXPECT_NEAR(kitti.lowest_deg, -24.8, 1e-9);
}

View view_over_scans(SensorKind kind) {
  View all;
  for (std::size_t scan_index = 0; scan_index < 50; ++scan_index) {
    const View view = view_of(beam_directions(sensor_model(kind), scan_index));
    all.highest_deg = std::max(all.highest_deg, view.highest_deg);
    all.lowest_deg = std::min(all.lowest_deg, view.lowest_deg);
    all.leftmost_deg = std::max(all.leftmost_deg, view.leftmost_deg);
    all.rightmost_deg = std::min(all.rightmost_deg, view.rightmost_deg);
  }
  return all;
}

TEST(SensorModel, FillsTheFieldOfViewOfLivoxSensorsOverManyScans) {
  const View all = view_over_scans(SensorKind::kAvia);
  EXPECT_NEAR(all.leftmost_deg - all.rightmost_deg, 70.4, 0.5);
  EXPECT_NEAR(all.highest_deg - all.lowest_deg, 77.2, 0.5);
  const View round = view_over_scans(SensorKind::kMid360);
  EXPECT_NEAR(round.leftmost_deg - round.rightmost_deg, 360.0, 0.5);
  EXPECT_NEAR(round.highest_deg, 52.0, 0.1);
  EXPECT_NEAR(round.lowest_deg, -7.0, 0.1);
}

TEST(SensorModel, OfLivoxDrawsAnotherPatternInEveryScan) {
  for (const SensorKind kind : {SensorKind::kAvia, SensorKind::kMid360}) {
    const SensorModel sensor = sensor_model(kind);
    EXPECT_FALSE(repeats_every_scan(sensor));
    const auto first = beam_directions(sensor, 0), second = beam_directions(sensor, 1);
    std::size_t equal = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      if ((first[i] - second[i]).norm() < 1e-3) ++equal;
    }
    EXPECT_LT(equal, first.size() / 100) << to_string(kind);
  }
}

TEST(SensorModel, OrdersSlotsByColumnAndWithinItByRingFromTheTop) {
  const SensorModel sensor = sensor_model(SensorKind::kOs1_64);
  const auto rays = beam_directions(sensor, 0);
  for (std::size_t ring = 1; ring < sensor.rings; ++ring) {
    ASSERT_LT(rays[ring].z(), rays[ring - 1].z());
    ASSERT_NEAR(std::atan2(rays[ring].y(), rays[ring].x()), std::atan2(rays[0].y(), rays[0].x()),
                1e-12);
    ASSERT_EQ(rays[64 + ring].z(), rays[ring].z());
  }
}

TEST(PortableSinCos, AgreesWithTheLibrary) {
  for (int i = -4000; i <= 4000; ++i) {
    const double angle_rad = 0.0137 * i;
    const SinCos own = sin_cos(angle_rad);
    ASSERT_NEAR(own.sin, std::sin(angle_rad), 4e-15) << angle_rad;
    ASSERT_NEAR(own.cos, std::cos(angle_rad), 4e-15) << angle_rad;
  }
}

TEST(NearlyNormal, HasMeanZeroVarianceOneAndItsBound) {
  double sum = 0.0, sum_of_squares = 0.0;
  constexpr int kDraws = 200000;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const double x = nearly_normal(random_word(5, i));
    ASSERT_LT(std::abs(x), kNormalBound);
    sum += x;
    sum_of_squares += x * x;
  }
  // Five standard errors of the mean and of the variance.
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 / std::sqrt(kDraws));
  EXPECT_NEAR(sum_of_squares / kDraws, 1.0, 5.0 * std::sqrt(2.0 / kDraws));
}

}  // namespace
}  // namespace mosbench
