#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

namespace mosbench {

/// The points of a scan in the order of x, to find those in a box without looking at all.
class PointsInBoxes {
 public:
  /// Keeps `points`, which have to outlive it.
  explicit PointsInBoxes(std::span<const Point> points);

  /// Gives all points within a box, its sides included, one label.
  void label(const Pose& box_from_sensor, const Eigen::Vector3d& half_size_m, std::uint32_t label,
             std::span<std::uint32_t> labels) const;

 private:
  std::span<const Point> points_;
  std::vector<std::uint32_t> order_;
};

}  // namespace mosbench
