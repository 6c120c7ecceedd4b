#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/odometry/scan_points.hpp"

namespace mosbench::odometry {

/// Moves every point to where the sensor would have seen it at the scan's stamp, given that it
/// moved by `motion` within `period_ns`. `times_ns` holds the time after the stamp of every row of
/// the scan; times farther than three periods from the stamp are taken for three.
std::vector<Eigen::Vector3d> deskewed(const ScanPoints& scan,
                                      std::span<const std::int64_t> times_ns, const Pose& motion,
                                      std::int64_t period_ns);

}  // namespace mosbench::odometry
