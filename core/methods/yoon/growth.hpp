#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/yoon/config.hpp"
#include "core/methods/yoon/residual.hpp"
#include "core/voxel/directions.hpp"

namespace mosbench::yoon {

/// Returns the seeds that stay, a flag per point: at least half of the points in the 3x3 pixels of
/// the scan's image around a seed, itself included, must be seeds. Pixels have the edge
/// `pixel_rad`; points with the range 0 are left out.
std::vector<std::uint8_t> filter_seeds(std::span<const Direction> directions,
                                       std::span<const std::uint8_t> seeds, double pixel_rad);

/// A scan and what is known of its points. All spans are one per point.
struct GrowthInput {
  std::span<const Eigen::Vector3f> points;  ///< in the frame of the reference
  std::span<const std::uint8_t> in_range;
  std::span<const Look> looks;
  std::span<const Eigen::Vector3f> reference;
  const PointCells& reference_cells;  ///< as residual_of takes them
};

/// Returns the points that grow from `kept`, breadth first, where the order decides nothing: to
/// points within growth_distance_m whose residual exceeds growth_residual_m, which blocks points on
/// planes that were there before. Points of unknown space join, but nothing grows from them.
std::vector<std::uint8_t> grow(std::vector<std::uint8_t> kept, const GrowthInput& input,
                               const Config& config);

}  // namespace mosbench::yoon
