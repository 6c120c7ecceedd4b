#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/odometry/config.hpp"

namespace mosbench::odometry {

/// The points of a scan that take part; the two arrays run together.
struct ScanPoints {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<std::size_t> rows;  ///< in the scan
};

/// Points with min^2 < x^2 + y^2 + z^2 < max^2, which leaves out NaN, raised by KITTI's correction
/// if asked for.
ScanPoints points_in_range(std::span<const Point> points, const ScanConfig& config);

/// Rotates a point by 0.205 degrees about p x (0,0,1), which mends the intrinsic calibration of
/// KITTI's HDL-64E. Points above the sensor stay.
Eigen::Vector3d raised(const Eigen::Vector3d& point_m);

/// The points whose row of the scan is not marked as moving.
ScanPoints without(const ScanPoints& scan, std::span<const std::uint8_t> moving);

/// Moves every point to where the sensor would have seen it at the scan's stamp, given that it
/// moved by `motion` within `period_ns`. `times_ns` holds the time after the stamp of every row of
/// the scan; times farther than three periods from the stamp are taken for three.
std::vector<Eigen::Vector3d> deskewed(const ScanPoints& scan,
                                      std::span<const std::int64_t> times_ns, const Pose& motion,
                                      std::int64_t period_ns);

}  // namespace mosbench::odometry
