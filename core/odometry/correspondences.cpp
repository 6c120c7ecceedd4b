#include "core/odometry/correspondences.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench::odometry {
namespace {

constexpr double kFarAway_m = 1e6;
// So that rounding cannot let a point go farther than it may.
constexpr double kRounding_m = 1e-9;

}  // namespace

Correspondences::Correspondences(std::size_t points, const PointGrid& map, double reach_m)
    : map_(map), reach_m_(reach_m), tracked_(points) {}

void Correspondences::search(Tracked& tracked, const Eigen::Vector3d& position_m) const {
  const Neighbour neighbour = map_.nearest(position_m, reach_m_);
  const bool found = std::isfinite(neighbour.distance_m);
  tracked.asked_m = position_m;
  tracked.nearest_m =
      found ? neighbour.point_m : position_m + Eigen::Vector3d::Constant(kFarAway_m);
  const double free_m =
      found ? (neighbour.others_m - neighbour.distance_m) / 2 : neighbour.others_m - reach_m_;
  const double safe_m = std::max(free_m - kRounding_m, 0.0);
  tracked.free_sq_m2 = safe_m * safe_m;
}

}  // namespace mosbench::odometry
