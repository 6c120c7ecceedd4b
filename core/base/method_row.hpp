#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "core/base/fields.hpp"

namespace mosbench {

/// MethodKind::check of a method with such a config.
template <typename Config>
void check_settings(const Settings& settings) {
  check(config_of<Config>(settings));
}

/// MethodKind::make of a method that is made of a config and a context.
template <typename Made, typename Config>
std::unique_ptr<Method> make_method(const Settings& settings, const RunContext& context) {
  return std::make_unique<Made>(config_of<Config>(settings), context);
}

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
