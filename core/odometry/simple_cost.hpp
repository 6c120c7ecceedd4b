#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/odometry/bfgs.hpp"
#include "core/odometry/point_grid.hpp"
#include "core/odometry/rigid_motion.hpp"

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

/// The inputs of SiMpLE's cost: scan points in the sensor frame, the map, and sigma.
struct SimpleProblem {
  std::span<const Eigen::Vector3d> points_m;
  const PointGrid& map;
  double sigma_m;
  double reach_m;  ///< neighbours farther than this count nothing; at least 10 sigma
};

/// f(m) = -sum_i exp(-|q_i - n_i|^2 / (2 sigma^2)) with q_i = R(m) p_i + t(m) and n_i its nearest
/// map point. Derivatives are central differences with steps of 1e-7, as in the authors' program,
/// and the sum runs in the order of the points.
class NumericCost : public Objective {
 public:
  NumericCost(const SimpleProblem& problem, ThreadPool& pool);
  double value(const Vector6d& at) override;
  Vector6d gradient(const Vector6d& at) override;
  double slope(const Vector6d& at, const Vector6d& direction, double step) override;

 private:
  SimpleProblem problem_;
  ThreadPool& pool_;
  Correspondences nearest_;
  std::vector<double> closeness_;
};

/// The same cost with the exact derivative, nearest neighbours held fixed.
class AnalyticCost : public Objective {
 public:
  AnalyticCost(const SimpleProblem& problem, ThreadPool& pool);
  double value(const Vector6d& at) override;
  Vector6d gradient(const Vector6d& at) override;
  double slope(const Vector6d& at, const Vector6d& direction, double step) override;
  /// The gradient is the sum over thousands of points, so that a step of 1 along it leads nowhere
  /// near.
  double first_step(const Vector6d& direction) const override;

 private:
  /// Sums over the points of a chunk, with w_i their closeness and r_i = q_i - n_i.
  struct Sums {
    double closeness = 0;                                // w_i
    Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // w_i r_i
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();    // w_i r_i p_i'
  };
  void evaluate(const Vector6d& at);
  Sums sums_of(std::size_t begin, std::size_t end, const Pose& pose);

  SimpleProblem problem_;
  ThreadPool& pool_;
  Correspondences nearest_;
  double mean_range_m_ = 0;
  std::vector<Sums> chunks_;
  std::optional<Vector6d> evaluated_at_;
  double value_ = 0;
  Vector6d gradient_;
};

}  // namespace mosbench::odometry
