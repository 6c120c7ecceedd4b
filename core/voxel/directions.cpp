#include "core/voxel/directions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

#include "core/base/beam_rows.hpp"

namespace mosbench {
namespace {

Direction direction_of(const Eigen::Vector3d& p) {
  const double range_m = std::sqrt((p.x() * p.x() + p.y() * p.y()) + p.z() * p.z());
  if (!(range_m > 0)) return {};
  // Single precision is a ten-thousandth of the spacing of beams, and several times as fast.
  const auto sine = static_cast<float>(p.z() / range_m);
  return {static_cast<float>(range_m),
          std::atan2(static_cast<float>(p.y()), static_cast<float>(p.x())),
          std::asin(std::clamp(sine, -1.0F, 1.0F))};
}

}  // namespace

std::vector<Direction> directions_of(std::span<const Point> points,
                                     const Pose& reference_from_sensor, const RangeWindow& window,
                                     ThreadPool& pool) {
  std::vector<Direction> directions(points.size());
  pool.for_ranges(points.size(), 2048, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d p(points[i].x, points[i].y, points[i].z);
      const double range_sq_m2 = (p.x() * p.x() + p.y() * p.y()) + p.z() * p.z();
      // NaN fails both.
      const bool takes_part = range_sq_m2 > window.above_m * window.above_m &&
                              range_sq_m2 <= window.up_to_m * window.up_to_m;
      if (takes_part) directions[i] = direction_of(reference_from_sensor * p);
    }
  });
  return directions;
}

void NeighbourAngle::measure(std::span<const Point> points, double min_range_m) {
  if (is_measured_ || least_rows_ == 0) return;
  const std::optional<RowSpacing> spacing = row_spacing(beam_directions(points, min_range_m));
  if (!spacing) return;
  is_measured_ = true;
  const double least_rad =
      std::min(least_rows_ * spacing->degrees / 180 * std::numbers::pi, kWidestAngle_rad);
  if (!spacing->is_regular || least_rad <= rad_) return;
  rad_ = least_rad;
  row_deg_ = spacing->degrees;
}

std::vector<std::string> NeighbourAngle::remarks() const {
  if (row_deg_ == 0) return {};
  std::ostringstream text;
  text << "The neighbour angle was widened to " << rad_ << " rad, as the sensor's rows are "
       << row_deg_ << " degrees apart.";
  return {text.str()};
}

}  // namespace mosbench
