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

/// A scan as others are registered to it, by its surfaces, and as it is registered to others, by
/// some points per cell, so that near surfaces do not outweigh far ones.
struct RegisteredScan {
  /// A surface with the directions in which it holds a point: a plane along its normal, a pole
  /// sideways. Rings on the ground hold a point in height only, because they move with the sensor.
  struct Surface {
    Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
    /// Per direction (columns) the variance of the surface's points along it; none where infinite.
    Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
    Eigen::Vector3d variance_m2 = Eigen::Vector3d::Zero();
    Eigen::Matrix3d information(double thickness_m) const;
  };

  RegisteredScan(std::span<const Point> points, double size_m);
  const Surface* surface_at(const Eigen::Vector3d& point_m) const;

  double cell_m;
  std::unordered_map<std::uint64_t, Surface> surfaces;
  std::vector<Eigen::Vector3d> upright_m;  ///< in columns that are not flat
  /// What each of them counts in the overlap, 1 in the sum. Points that hold the scan in a
  /// direction in which few do count more: on a straight road, posts more than the barrier.
  std::vector<double> leverage;
  std::vector<Eigen::Vector3d> ground_m;  ///< in flat columns
};

/// Returns some points of flat surfaces, about one per square metre.
std::vector<Eigen::Vector3d> sparse_ground_m(std::span<const Point> points);

/// A motion measured by two scans.
struct Registration {
  Pose motion = Pose::Identity();  ///< earlier_from_later
  double overlap = 0.0;            ///< of upright surfaces, 0 to 1
  /// Of (translation, rotation) errors of the motion, in the frame of the earlier scan.
  Matrix6 covariance = Matrix6::Zero();
};

double upright_overlap(const RegisteredScan& earlier, const RegisteredScan& later,
                       const Pose& motion, std::size_t step = 1, double thickness_m = 0.05);
/// Returns the motion near `start` that brings the later scan onto the surfaces of the earlier.
Registration registered(const RegisteredScan& earlier, const RegisteredScan& later,
                        const Pose& start);
/// Returns a start for `registered`, found among translations of up to 4 m sideways.
Pose searched_start(const RegisteredScan& earlier, const RegisteredScan& later);

}  // namespace mosbench
