#pragma once

#include <sstream>
#include <stdexcept>
#include <string_view>

namespace mosbench {

/// Throws std::invalid_argument when the range limits leave no point.
inline void check_range_limits(double min_range_m, double max_range_m) {
  if (min_range_m < max_range_m) return;
  throw std::invalid_argument("min_range_m: not below max_range_m, expected min < max");
}

/// Throws std::invalid_argument when the setting `name` is longer than `most` voxels, whose edge is
/// the setting `edge`.
inline void check_voxels(std::string_view name, double voxels, std::string_view edge, double most) {
  if (voxels <= most) return;
  std::ostringstream message;
  message << name << ": " << voxels << " voxels of " << edge << ", expected at most " << most;
  throw std::invalid_argument(message.str());
}

}  // namespace mosbench
