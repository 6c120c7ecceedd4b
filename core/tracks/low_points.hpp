#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace mosbench::tracks {

/// Says of each position whether it is less than 0.2 m above the lowest one in the square metres
/// around: rays pass above level ground, so that looks at it say little. Positions whose `part` is
/// 0 are left out.
std::vector<std::uint8_t> low_points(std::span<const Eigen::Vector3f> positions_m,
                                     std::span<const std::uint8_t> part);

}  // namespace mosbench::tracks
