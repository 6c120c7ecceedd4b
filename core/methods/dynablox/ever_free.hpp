#pragma once

#include <cstdint>

#include "core/base/thread_pool.hpp"
#include "core/methods/dynablox/config.hpp"
#include "core/methods/dynablox/ever_free_map.hpp"
#include "core/voxel/voxel_set.hpp"

namespace mosbench::dynablox {

/// Brings the ever-free voxels of the blocks touched by the last integration up to frame f, whose
/// points lie in `measured`. First, each voxel that is near a surface or holds a point is occupied:
/// c = c + 1 if O >= f - buffer, else 1; O = f. An ever-free voxel with c at the limit is ever-free
/// no more, nor are its 26 neighbours. Then each observed voxel becomes ever-free when it and its
/// 26 neighbours are observed and were not occupied since frame f - burn-in.
void update_ever_free(EverFreeMap& map, const VoxelSet& measured, std::int32_t frame,
                      const Config& config, ThreadPool& pool);

}  // namespace mosbench::dynablox
