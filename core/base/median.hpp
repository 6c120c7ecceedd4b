#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mosbench {

/// Median of a list in any order, for even sizes the upper middle value; 0 of an empty one.
inline double upper_median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace mosbench
