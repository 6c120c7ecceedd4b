#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/methods/yoon/config.hpp"
#include "core/methods/yoon/residual.hpp"
#include "core/voxel/direction_grid.hpp"

namespace mosbench::yoon {

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
