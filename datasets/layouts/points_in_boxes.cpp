#include "datasets/layouts/points_in_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/formats/point_range.hpp"

namespace mosbench {

PointsInBoxes::PointsInBoxes(std::span<const Point> points) : points_(points) {
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!std::isnan(points[i].x)) order_.push_back(i);
  }
  std::ranges::sort(order_, {}, [&](std::uint32_t i) { return points_[i].x; });
}

void PointsInBoxes::label(const Pose& box_from_sensor, const Eigen::Vector3d& half_size_m,
                          std::uint32_t label, std::span<std::uint32_t> labels) const {
  const double x_m = box_from_sensor.inverse().translation().x();
  // A little more on either side: the rounding of the motion must lose no point.
  const double reach_m = half_size_m.norm() + 1e-5 * (1.0 + std::abs(x_m));
  const auto x_of = [&](std::uint32_t i) { return static_cast<double>(points_[i].x); };
  const double low_m = x_m - reach_m, high_m = x_m + reach_m;
  for (auto i = std::ranges::lower_bound(order_, low_m, {}, x_of); i != order_.end(); ++i) {
    if (x_of(*i) > high_m) break;
    const Eigen::Vector3d p = box_from_sensor * position_of(points_[*i]);
    if ((p.cwiseAbs().array() <= half_size_m.array()).all()) labels[*i] = label;
  }
}

}  // namespace mosbench
