#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// What made a simulated data set. It is stored in `simulated.json` at its root, so that results
/// from it are never mistaken for those of the real one.
struct SimulatedOrigin {
  DatasetKind layout = DatasetKind::kSemanticKitti;
  std::string scene;              ///< its name
  std::string scene_fingerprint;  ///< hash of the whole scene
  std::size_t scans = 0;
  std::uint64_t seed = 0;
  std::optional<std::string> perturb = std::nullopt;  ///< disturbances, where there are any

  bool operator==(const SimulatedOrigin&) const = default;
};

inline constexpr std::string_view kSimulatedMarker = "simulated.json";

/// Returns the origin of the data set that `path` belongs to, searched there and up to four folders
/// above; nothing for recorded data. Throws DataError for a marker that cannot be read.
std::optional<SimulatedOrigin> simulated_origin(const std::filesystem::path& path);

SimulatedOrigin parse_simulated_origin(std::string_view text, const std::filesystem::path& file);
std::string format_simulated_origin(const SimulatedOrigin& origin);

}  // namespace mosbench
