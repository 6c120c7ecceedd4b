#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>

#include "core/base/thread_pool.hpp"
#include "core/tsdf/range_image.hpp"
#include "core/tsdf/sensor_model.hpp"
#include "core/tsdf/tsdf_map.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::tsdf {

/// A scan as its range image, seen from where it was taken.
struct Depths {
  const RangeImage& image;
  const SensorModel& sensor;
  const Pose& map_from_sensor;
};

/// Integrates the depths into the voxels of the given blocks, eight per wide block as `touch`
/// returns. For a voxel whose centre has range rho within limits and lies in the field of view, sdf
/// = depth - rho; if sdf >= -tau it weighs k = K / rho^2, less by (tau + sdf) / (tau - v) behind
/// sdf = -v, and d moves to min(tau, sdf) by the share k / (w + k), which is the weighted mean (d w
/// + min(tau, sdf) k) / (w + k); w = min(w + k, most). Blocks that bounds of the depths show to be
/// hidden are left alone, and those in free space need no image: the numbers are the same bits.
void integrate(TsdfMap& map, std::span<const std::uint32_t> slots, const VoxelGrid& grid,
               const Depths& depths, const Config& config, ThreadPool& pool);

}  // namespace mosbench::tsdf
