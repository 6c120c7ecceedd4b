#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/otsu.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Otsu's threshold T on S(v) of all occupied voxels.
std::optional<double> threshold_of(const VoxelizedScan& scan, const SumField& sums);

/// Steps 5h and 6.2: whether a scan with this T shows any motion at all.
inline bool shows_motion(std::optional<double> threshold, int min_otsu_score) {
  return threshold.value_or(0.0) > min_otsu_score;
}

/// algorithm steps 5d to 5f: occupied voxels with S > T and those of `carried` with S >
/// min_otsu_score, then all occupied voxels in their 27-neighbourhoods. The result is a set of the
/// scan's occupied voxels.
VoxelSet select_dynamic(const VoxelizedScan& scan, const SumField& sums,
                        std::optional<double> threshold, const VoxelSet& carried,
                        int min_otsu_score);

/// The voxels in either set.
VoxelSet united(VoxelSet some, const VoxelSet& more);

}  // namespace mosbench::hmm_mos
