#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/voxel/directions.hpp"

namespace mosbench::yoon {

/// Returns the seeds that stay, a flag per point: at least half of the points in the 3x3 pixels of
/// the scan's image around a seed, itself included, must be seeds. Pixels have the edge
/// `pixel_rad`; points with the range 0 are left out.
std::vector<std::uint8_t> filter_seeds(std::span<const Direction> directions,
                                       std::span<const std::uint8_t> seeds, double pixel_rad);

}  // namespace mosbench::yoon
