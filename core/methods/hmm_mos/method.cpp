#include "core/methods/hmm_mos/method.hpp"

#include "core/base/method_row.hpp"
#include "core/methods/hmm_mos/config.hpp"
#include "core/methods/hmm_mos/pipeline.hpp"
#include "core/methods/hmm_mos/reference.hpp"

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
          .threshold_name = kThresholdName};
}

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
