#include "datasets/sequence/simulated_origin.hpp"

#include <nlohmann/json.hpp>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"

namespace mosbench {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string format_simulated_origin(const SimulatedOrigin& origin) {
  Json marker = {{"simulated", true},     {"layout", origin.layout},
                 {"scene", origin.scene}, {"scene_fingerprint", origin.scene_fingerprint},
                 {"scans", origin.scans}, {"seed", origin.seed}};
  if (origin.perturb) marker["perturb"] = *origin.perturb;
  return marker.dump(2) + "\n";
}

SimulatedOrigin parse_simulated_origin(std::string_view text, const std::filesystem::path& file) {
  try {
    const Json marker = parse_json(text, file);
    SimulatedOrigin origin{.layout = marker.at("layout").get<std::string>(),
                           .scene = marker.at("scene").get<std::string>(),
                           .scene_fingerprint = marker.at("scene_fingerprint").get<std::string>(),
                           .scans = marker.at("scans").get<std::size_t>(),
                           .seed = marker.at("seed").get<std::uint64_t>()};
    if (marker.contains("perturb")) origin.perturb = marker.at("perturb").get<std::string>();
    return origin;
  } catch (const Json::exception& error) {
    throw DataError(file, "cannot be understood (" + sentence_of(error) + ")",
                    "a marker written by mosbench");
  }
}

std::optional<SimulatedOrigin> simulated_origin(const std::filesystem::path& folder) {
  const std::filesystem::path marker = folder / kSimulatedMarker;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(marker, ignored)) return std::nullopt;
  return parse_simulated_origin(read_file(marker), marker);
}

std::optional<SimulatedOrigin> origin_of_file(const std::filesystem::path& file,
                                              int folders_above) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(file, error).parent_path();
  for (int above = 0; above <= folders_above && !error; ++above) {
    if (auto origin = simulated_origin(folder)) return origin;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

}  // namespace mosbench
