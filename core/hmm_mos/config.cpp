#include "core/hmm_mos/config.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "core/hmm_mos/hmm.hpp"
#include "core/voxel/distance_field.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench {
namespace {

template <typename Number>
void check_field(std::string_view name, Number value, FieldRange range) {
  const double number = static_cast<double>(value);
  if (std::isfinite(number) && number >= range.lowest && number <= range.highest) return;
  std::ostringstream message;
  message << name << ": " << number << " is out of range, expected " << range.lowest << " to "
          << range.highest;
  throw std::invalid_argument(message.str());
}

void check_field(std::string_view name, const std::optional<double>& value, FieldRange range) {
  if (value) check_field(name, *value, range);
}

void check_voxels(std::string_view name, double voxels, double most) {
  if (voxels <= most) return;
  std::ostringstream message;
  message << name << ": " << voxels << " voxels of voxel_size_m, expected at most " << most;
  throw std::invalid_argument(message.str());
}

}  // namespace

std::string_view to_string(Variant variant) {
  return variant == Variant::kPaper2024 ? "paper-2024" : "release-2025";
}

std::optional<Variant> variant_from_string(std::string_view name) {
  for (const Variant variant : {Variant::kPaper2024, Variant::kRelease2025}) {
    if (name == to_string(variant)) return variant;
  }
  return std::nullopt;
}

void check(const Config& config) {
  visit_fields(config, [](std::string_view name, const auto& value, FieldRange range) {
    check_field(name, value, range);
  });
  if (config.kernel_width_voxels % 2 == 0) {
    throw std::invalid_argument(
        "kernel_width_voxels: " + std::to_string(config.kernel_width_voxels) +
        " is even, expected an odd width");
  }
  if (config.min_range_m >= config.max_range_m) {
    throw std::invalid_argument("min_range_m: not below max_range_m, expected min < max");
  }
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, kMaxRangeVoxels);
  // The distance field reaches as far as a likelihood can matter.
  const double reach_per_sigma =
      likelihood_reach_sigmas(config.transition_epsilon, config.min_state_probability);
  check_voxels("occupancy_sigma_m", config.sigma_m() / config.voxel_size_m,
               kMaxDistanceRadius / reach_per_sigma);
}

}  // namespace mosbench
