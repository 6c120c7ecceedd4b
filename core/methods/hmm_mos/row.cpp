#include <stdexcept>
#include <string>

#include "core/base/method_row.hpp"
#include "core/base/range_limits.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/hmm.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "core/methods/hmm_mos/reference.hpp"
#include "core/voxel/distance_field.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::hmm_mos {
namespace {

constexpr std::string_view kSource =
    "Bhandari, James, Phillips, McAree: Moving Object Segmentation in Point Cloud Data using "
    "Hidden Markov Models, 2024, arXiv:2410.18638";
constexpr std::string_view kScoreName = "dynamic score";
constexpr std::string_view kThresholdName = "Otsu threshold";

std::unique_ptr<Method> make_slow(const Settings& settings, const RunContext& context) {
  return make_reference(config_of<Config>(settings), context);
}

}  // namespace

void check(const Config& config) {
  check_ranges(config);
  if (config.kernel_width_voxels % 2 == 0) {
    throw std::invalid_argument(
        "kernel_width_voxels: " + std::to_string(config.kernel_width_voxels) +
        " is even, expected an odd width");
  }
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
  // The distance field reaches as far as a likelihood can change a state.
  const double reach_per_sigma =
      likelihood_reach_sigmas(config.transition_epsilon, config.min_state_probability);
  check_voxels("occupancy_sigma_m", config.sigma_m() / config.voxel_size_m, "voxel_size_m",
               kMaxDistanceRadius / reach_per_sigma);
  if (config.variant == Variant::kRelease2025 && config.delay_scans != 0) {
    throw std::invalid_argument("delay_scans: " + std::to_string(config.delay_scans) +
                                " in release-2025, which has no delay, expected 0");
  }
}

/// "hmm-mos": the pipeline behind the interface of all methods.
MethodKind method_kind() {
  return {.name = "hmm-mos",
          .title = "HMM-MOS",
          .source = kSource,
          .summary =
              "a three-state hidden Markov model per voxel, changes convolved over space and time",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = kScoreName,
          .threshold_name = kThresholdName,
          .is_named_by_variant = true};
}

/// "hmm-mos-reference": the same labels by the obvious code of reference.hpp, hundreds of times
/// slower.
MethodKind reference_kind() {
  return {
      .name = "hmm-mos-reference",
      .title = "HMM-MOS (reference)",
      .source = kSource,
      .summary = "the same labels, step by step as in the paper; up to thousands of times slower",
      .defaults = settings_of(Config{}),
      .check = check_settings<Config>,
      .make = make_slow,
      .is_twin = true,
      .score_name = kScoreName,
      .threshold_name = kThresholdName};
}

}  // namespace mosbench::hmm_mos
