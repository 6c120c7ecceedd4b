#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace mosbench::hmm_mos {

/// So many voxels have this value.
struct ValueCount {
  std::int32_t value = 0;
  std::size_t count = 0;
};

/// algorithm step 5d: Otsu's threshold over 100 bins between the least and the greatest value. A
/// value may come in several entries. Nothing when no level separates the values.
std::optional<double> otsu_threshold(std::span<const ValueCount> values);

}  // namespace mosbench::hmm_mos
