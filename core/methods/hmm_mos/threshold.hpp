#pragma once

#include <optional>

#include "core/voxel/voxel_field.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// Returns Otsu's threshold T on L^dyn of all occupied voxels (paper, III).
std::optional<double> threshold_of(const VoxelizedScan& scan, const SumField& sums);

/// Returns whether a scan with this T has moving points at all: T > otsu_min, as the authors'
/// program asks.
inline bool shows_motion(std::optional<double> threshold, int min_otsu_score) {
  return threshold.value_or(0.0) > min_otsu_score;
}

/// Returns the occupied voxels with L^dyn > T (paper, III) and, as the authors' program does, those
/// of `carried` with L^dyn > min_otsu_score.
VoxelSet above_threshold(const VoxelizedScan& scan, const SumField& sums,
                         std::optional<double> threshold, const VoxelSet& carried,
                         int min_otsu_score);

}  // namespace mosbench::hmm_mos
