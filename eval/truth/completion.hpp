#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace mosbench {

/// Completes objects in one scan: of each point that `part` says 0 of, returns the value of the
/// nearest other one within 0.3 m, if the point is 0.05 to 0.5 m above the lowest one in the 2.5 m
/// square around it; else 0. So low, looks along the ground see no difference: of feet and wheels
/// methods miss a part, while walls and trees that an object touches begin mostly above.
std::vector<std::uint32_t> completed_by(std::span<const Eigen::Vector3d> positions_map_m,
                                        std::span<const std::uint32_t> part);

/// Returns how far each point is above the lowest one in the 2.5 m square around it; NaN for a
/// point that is no number.
std::vector<double> heights_m(std::span<const Eigen::Vector3d> positions_map_m);

}  // namespace mosbench
