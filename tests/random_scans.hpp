#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mosbench/scan.hpp>
#include <random>
#include <span>
#include <vector>

namespace mosbench {

struct RandomScan {
  std::vector<std::uint32_t> truth, prediction;
  std::vector<Point> points;
};

/// Label ids that each protocol treats in its own way, at and beside every threshold.
inline constexpr std::array<std::uint32_t, 24> kAllIds = {
    0,   1,   2,   3,   9,   10,  12,  40,  99,  100,  250,   251,
    252, 253, 259, 260, 300, 351, 358, 359, 999, 1000, 65534, 65535};

/// A point in front of the sensor, often exactly at 0.5 or 20 m, sometimes without finite range.
inline Point random_point(std::mt19937& random) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::array<Point, 8> special = {{{0.5F, 0.0F, 0.0F, 0.0F},
                                         {0.0F, 0.0F, 20.0F, 0.0F},
                                         {12.0F, -16.0F, 0.0F, 0.0F},
                                         {12.000001F, 16.0F, 0.0F, 0.0F},
                                         {0.3F, 0.4F, 0.0F, 0.0F},
                                         {0.0F, 0.0F, 0.0F, 0.0F},
                                         {nan, 1.0F, 1.0F, 0.0F},
                                         {1.0F, infinity, 1.0F, 0.0F}}};
  const std::size_t choice = random() % 32;
  if (choice < special.size()) return special[choice];
  std::uniform_real_distribution<float> coordinate(-15.0F, 15.0F);
  return {coordinate(random), coordinate(random), coordinate(random) / 5.0F, 0.0F};
}

/// Labels drawn from `ids` with instance numbers in the upper 16 bits of every other point.
inline RandomScan random_scan(std::mt19937& random, std::size_t points,
                              std::span<const std::uint32_t> ids) {
  RandomScan scan;
  const auto label = [&] {
    const std::uint32_t instance = random() % 2 == 0 ? 0U : static_cast<std::uint32_t>(random());
    return (instance & 0xFFFF0000U) | ids[random() % ids.size()];
  };
  for (std::size_t i = 0; i < points; ++i) {
    scan.truth.push_back(label());
    scan.prediction.push_back(label());
    scan.points.push_back(random_point(random));
  }
  return scan;
}

}  // namespace mosbench
