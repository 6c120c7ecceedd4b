#pragma once

#include <optional>
#include <vector>

#include "core/methods/hmm_mos/otsu.hpp"

namespace mosbench::hmm_mos {

/// Returns the threshold of values that are given one by one.
inline std::optional<double> otsu_of(const std::vector<int>& values) {
  std::vector<ValueCount> entries;
  for (const int value : values) entries.push_back({value, 1});
  return otsu_threshold(entries);
}

}  // namespace mosbench::hmm_mos
