#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "core/odometry/point_grid.hpp"

namespace mosbench::odometry {

/// The nearest map point of every scan point during the search for a pose. A scan point that moved
/// less than half the gap between its nearest and second nearest map point keeps its nearest one.
/// So most questions need no search; the answers are the same as with one.
class Correspondences {
 public:
  /// Neighbours farther than `reach_m` may be left out. The map must outlive this and not change.
  Correspondences(std::size_t points, const PointGrid& map, double reach_m);

  /// The nearest map point of point `i`, which now lies at `position_m`; a point very far away when
  /// there is none within reach. Different points may be asked for from different threads.
  const Eigen::Vector3d& nearest(std::size_t i, const Eigen::Vector3d& position_m) {
    Tracked& tracked = tracked_[i];
    if (!((position_m - tracked.asked_m).squaredNorm() < tracked.free_sq_m2)) {
      search(tracked, position_m);
    }
    return tracked.nearest_m;
  }

 private:
  struct Tracked {
    Eigen::Vector3d asked_m, nearest_m;
    double free_sq_m2 = 0;  // moves shorter than this change nothing
  };
  void search(Tracked& tracked, const Eigen::Vector3d& position_m) const;

  const PointGrid& map_;
  double reach_m_;
  std::vector<Tracked> tracked_;
};

}  // namespace mosbench::odometry
