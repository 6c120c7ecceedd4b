#include "eval/results/simulated.hpp"

#include <fmt/format.h>

#include "datasets/layouts/simulated_origin.hpp"

namespace mosbench {
namespace {

std::string words_of(const SimulatedOrigin& origin) {
  return fmt::format("scene {}, seed {}{}", origin.scene, origin.seed,
                     origin.perturb ? ", disturbed by " + *origin.perturb : "");
}

/// A folder of data may hold links to sequences of others.
std::optional<SimulatedOrigin> origin_of(const Dataset& dataset, const Sequence& sequence) {
  if (auto origin = simulated_origin(dataset.root)) return origin;
  if (const auto scan = sequence.scan_file(0)) return simulated_origin(*scan);
  const std::vector<std::filesystem::path>& files = sequence.recording().files;
  return files.empty() ? std::nullopt : simulated_origin(files.front());
}

std::optional<SimulatedOrigin> origin_of(const Dataset& dataset) {
  for (const std::unique_ptr<Sequence>& sequence : dataset.sequences) {
    if (auto origin = origin_of(dataset, *sequence)) return origin;
  }
  return std::nullopt;
}

nlohmann::ordered_json to_json(const SimulatedOrigin& origin) {
  nlohmann::ordered_json members = {
      {"scene", origin.scene},
      {"seed", origin.seed},
      {"scene_fingerprint", origin.scene_fingerprint},
      {"notice", fmt::format("simulated data ({}): not comparable with "
                             "published numbers",
                             words_of(origin))}};
  if (origin.perturb) members["perturb"] = *origin.perturb;
  return members;
}

}  // namespace

std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset,
                                                            const Sequence& sequence) {
  const std::optional<SimulatedOrigin> origin = origin_of(dataset, sequence);
  return origin ? std::optional(to_json(*origin)) : std::nullopt;
}

std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset) {
  const std::optional<SimulatedOrigin> origin = origin_of(dataset);
  return origin ? std::optional(to_json(*origin)) : std::nullopt;
}

Standing standing_of(const Dataset& dataset) {
  const std::optional<SimulatedOrigin> origin = origin_of(dataset);
  return origin ? Standing{true, words_of(*origin)} : Standing{};
}

}  // namespace mosbench
