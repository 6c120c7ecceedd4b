#include "datasets/layouts/simulated_origin.hpp"

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
  Json marker = {{"simulated", true},     {"layout", to_string(origin.layout)},
                 {"scene", origin.scene}, {"scene_fingerprint", origin.scene_fingerprint},
                 {"scans", origin.scans}, {"seed", origin.seed}};
  if (origin.perturb) marker["perturb"] = *origin.perturb;
  return marker.dump(2) + "\n";
}

SimulatedOrigin parse_simulated_origin(std::string_view text, const std::filesystem::path& file) {
  try {
    const Json marker = parse_json(text, file);
    const auto layout = dataset_kind_from_string(marker.at("layout").get<std::string>());
    if (!layout) throw DataError(file, "its layout is unknown", "a marker written by mosbench");
    SimulatedOrigin origin{.layout = *layout,
                           .scene = marker.at("scene").get<std::string>(),
                           .scene_fingerprint = marker.at("scene_fingerprint").get<std::string>(),
                           .scans = marker.at("scans").get<std::size_t>(),
                           .seed = marker.at("seed").get<std::uint64_t>()};
    if (marker.contains("perturb")) origin.perturb = marker.at("perturb").get<std::string>();
    return origin;
  } catch (const Json::exception& error) {
    throw DataError(file, std::string("cannot be understood (") + error.what() + ")",
                    "a marker written by mosbench");
  }
}

std::optional<SimulatedOrigin> simulated_origin(const std::filesystem::path& path) {
  constexpr int kFoldersAbove = 4;
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(path, error);
  if (error) return std::nullopt;
  for (int i = 0; i <= kFoldersAbove; ++i) {
    const std::filesystem::path marker = folder / kSimulatedMarker;
    if (std::filesystem::is_regular_file(marker, error)) {
      return parse_simulated_origin(read_file(marker), marker);
    }
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

}  // namespace mosbench
