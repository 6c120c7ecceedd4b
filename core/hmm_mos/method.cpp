#include "core/hmm_mos/method.hpp"

#include "core/hmm_mos/config.hpp"
#include "core/hmm_mos/pipeline.hpp"
#include "core/hmm_mos/reference.hpp"

namespace mosbench::hmm_mos {
namespace {

constexpr std::string_view kSource =
    "Bhandari, James, Phillips, McAree: Moving Object Segmentation in Point Cloud Data using "
    "Hidden Markov Models, 2024, arXiv:2410.18638";

void check_settings(const Settings& settings) { check(config_of<Config>(settings)); }

std::unique_ptr<Method> make_fast(const Settings& settings, const RunContext& context) {
  return std::make_unique<Pipeline>(config_of<Config>(settings), context);
}

std::unique_ptr<Method> make_slow(const Settings& settings, const RunContext& context) {
  return make_reference(config_of<Config>(settings), context);
}

}  // namespace

MethodKind method_kind() {
  return {"hmm-mos",
          "HMM-MOS",
          kSource,
          "a three-state hidden Markov model per voxel, changes convolved over space and time",
          settings_of(Config{}),
          check_settings,
          make_fast};
}

MethodKind reference_kind() {
  return {"hmm-mos-reference",
          "HMM-MOS (reference)",
          kSource,
          "the same labels, step by step as the paper has it; some hundred times slower",
          settings_of(Config{}),
          check_settings,
          make_slow};
}

}  // namespace mosbench::hmm_mos
