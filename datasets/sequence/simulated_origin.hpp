#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mosbench {

/// What made a simulated sequence. It is stored in `simulated.json` in the sequence's own folder,
/// and moves with it, so that results from it are never mistaken for those of recorded data.
struct SimulatedOrigin {
  std::string layout;             ///< of its files
  std::string scene;              ///< its name
  std::string scene_fingerprint;  ///< hash of the whole scene
  std::size_t scans = 0;
  std::uint64_t seed = 0;
  std::optional<std::string> perturb = std::nullopt;  ///< disturbances, where there are any

  bool operator==(const SimulatedOrigin&) const = default;
};

inline constexpr std::string_view kSimulatedMarker = "simulated.json";

/// Returns the origin that `folder` holds; nothing for recorded data. Throws DataError for a marker
/// that cannot be read.
std::optional<SimulatedOrigin> simulated_origin(const std::filesystem::path& folder);

/// Returns the origin that lies beside one of a sequence's files, wherever links lead, or at most
/// `folders_above` folders above that.
std::optional<SimulatedOrigin> origin_of_file(const std::filesystem::path& file, int folders_above);

SimulatedOrigin parse_simulated_origin(std::string_view text, const std::filesystem::path& file);
std::string format_simulated_origin(const SimulatedOrigin& origin);

}  // namespace mosbench
