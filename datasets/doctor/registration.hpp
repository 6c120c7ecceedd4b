#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace mosbench {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The surfaces of a scan, each with the directions in which it holds a point: a plane along its
/// normal, a pole sideways. Rings on the ground hold a point in height only, because they move with
/// the sensor.
class HoldingSurfaces {
 public:
  HoldingSurfaces(std::span<const Eigen::Vector3d> points_m, double cell_m);

  struct Surface {
    Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
    /// Per direction (columns) the variance of the surface's points along it; none where infinite.
    Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
    Eigen::Vector3d variance_m2 = Eigen::Vector3d::Zero();
    Eigen::Matrix3d information(double thickness_m) const;
  };
  const Surface* at(const Eigen::Vector3d& point_m) const;

 private:
  double cell_m_ = 1.0;
  std::unordered_map<std::uint64_t, Surface> surfaces_;
};

/// Points of one scan for registration: some per cell, so that near surfaces do not outweigh far
/// ones.
struct SparseScan {
  std::vector<Eigen::Vector3d> upright_m;  ///< in columns that are not flat
  /// What each of them counts in the overlap, 1 in the sum. Points that hold the scan in a
  /// direction in which few do count more: on a straight road, posts more than the barrier.
  std::vector<double> leverage;
  std::vector<Eigen::Vector3d> ground_m;  ///< in flat columns
};

/// A scan in both roles.
struct RegisteredScan {
  HoldingSurfaces surfaces;
  SparseScan points;
};
/// Returns some points of flat surfaces, about one per square metre.
std::vector<Eigen::Vector3d> sparse_ground_m(std::span<const Point> points);
RegisteredScan registered_scan(std::span<const Point> points, double cell_m);

/// A motion measured by two scans.
struct Registration {
  Pose motion = Pose::Identity();  ///< earlier_from_later
  double overlap = 0.0;            ///< of upright surfaces, 0 to 1
  /// Of (translation, rotation) errors of the motion, in the frame of the earlier scan.
  Matrix6 covariance = Matrix6::Zero();
};

double upright_overlap(const HoldingSurfaces& earlier, const SparseScan& later, const Pose& motion,
                       std::size_t step = 1, double thickness_m = 0.05);
/// Returns the motion near `start` that brings the later scan onto the surfaces of the earlier.
Registration registered(const HoldingSurfaces& earlier, const SparseScan& later, const Pose& start);
/// Returns a start for `registered`, found among translations of up to `reach_m` sideways.
Pose searched_start(const HoldingSurfaces& earlier, const SparseScan& later, double reach_m);

}  // namespace mosbench
