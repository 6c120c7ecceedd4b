#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

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

}  // namespace mosbench::hmm_mos
