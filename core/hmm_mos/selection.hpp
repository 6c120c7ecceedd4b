#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/otsu.hpp"
#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns Otsu's threshold T on the scores L^dyn of all occupied voxels (paper, III).
std::optional<double> threshold_of(const VoxelizedScan& scan, const SumField& sums);

/// Returns whether a scan with this T has moving points at all: T > otsu_min (paper, III).
inline bool shows_motion(std::optional<double> threshold, int min_otsu_score) {
  return threshold.value_or(0.0) > min_otsu_score;
}

/// Returns the dynamic voxels of a scan: occupied voxels with L^dyn > T and, as the authors'
/// program does, those of `carried` with L^dyn > min_otsu_score; then, by nearest-neighbour
/// dilation (paper, III), all occupied voxels among the 27 around each of them.
VoxelSet select_dynamic(const VoxelizedScan& scan, const SumField& sums,
                        std::optional<double> threshold, const VoxelSet& carried,
                        int min_otsu_score);

/// Returns the voxels in either set.
VoxelSet united(VoxelSet some, const VoxelSet& more);

}  // namespace mosbench::hmm_mos
