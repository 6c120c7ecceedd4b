#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/thread_pool.hpp"
#include "core/voxel/voxel_set.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {

/// `count` voxels have the value `value`.
struct ValueCount {
  std::int32_t value = 0;
  std::size_t count = 0;
};

/// Returns Otsu's threshold T (paper, III), the level that maximises the variance between the
/// classes w0 w1 (mu0 - mu1)^2, of 100 bins between the least and the greatest value; among equal
/// levels the highest. A value may come in several entries. nullopt when all values are equal. (N.
/// Otsu, "A Threshold Selection Method from Gray-Level Histograms", 1979.)
std::optional<double> otsu_threshold(std::span<const ValueCount> values);

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

/// Nearest-neighbour dilation (paper, III): returns the occupied voxels of the scan among the 27
/// around each voxel of `dynamic`.
VoxelSet dilate_occupied(const VoxelizedScan& scan, const VoxelSet& dynamic, ThreadPool& pool);

}  // namespace mosbench::hmm_mos
