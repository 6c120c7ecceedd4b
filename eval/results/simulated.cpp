#include "eval/results/simulated.hpp"

#include <fmt/format.h>

#include "datasets/layouts/simulated_origin.hpp"

namespace mosbench {
namespace {

std::string notice(const SimulatedOrigin& origin) {
  return fmt::format("simulated data (scene {}, seed {}{}): not comparable with published numbers",
                     origin.scene, origin.seed,
                     origin.perturb ? ", disturbed by " + *origin.perturb : "");
}

}  // namespace

std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset) {
  const std::optional<SimulatedOrigin> origin = simulated_origin(dataset.root);
  if (!origin) return std::nullopt;
  nlohmann::ordered_json json = {{"scene", origin->scene},
                                 {"seed", origin->seed},
                                 {"scene_fingerprint", origin->scene_fingerprint},
                                 {"notice", notice(*origin)}};
  if (origin->perturb) json["perturb"] = *origin->perturb;
  return json;
}

std::string simulated_remark(const Dataset& dataset) {
  const std::optional<SimulatedOrigin> origin = simulated_origin(dataset.root);
  return origin ? notice(*origin) + '\n' : std::string();
}

}  // namespace mosbench
