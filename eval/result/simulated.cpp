#include "eval/result/simulated.hpp"

#include <fmt/format.h>

#include "eval/result/result_json.hpp"

namespace mosbench {
namespace {

std::string words_of(const SimulatedOrigin& origin) {
  return fmt::format("scene {}, seed {}{}", origin.scene, origin.seed,
                     origin.perturb ? ", disturbed by " + *origin.perturb : "");
}

}  // namespace

std::string simulated_notice(const SimulatedOrigin& origin) {
  return fmt::format("simulated data ({}): not comparable with published numbers",
                     words_of(origin));
}

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

std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset) {
  const std::optional<SimulatedOrigin> origin = origin_of(dataset);
  return origin ? std::optional(to_json(*origin)) : std::nullopt;
}

Standing standing_of(const Dataset& dataset) {
  const std::optional<SimulatedOrigin> origin = origin_of(dataset);
  return origin ? Standing{true, words_of(*origin)} : Standing{};
}

}  // namespace mosbench
