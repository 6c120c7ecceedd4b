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

/// Beside data that were disturbed on purpose, "disturbed: range_noise_m=0.05,seed=3" in its first
/// line. Of simulated data the other marker says it, too.
inline constexpr std::string_view kDisturbedMarker = "disturbed.txt";

/// What made the stored data of a sequence other than a sensor. Its mark lies in the sequence's own
/// folder, or in its bag, and moves with it.
struct DataMark {
  std::optional<SimulatedOrigin> simulated;
  std::string disturbed;  ///< by what; empty: not disturbed

  bool is_set() const { return simulated || !disturbed.empty(); }
};

/// Returns the mark that `folder` holds. Throws DataError for one that cannot be read.
DataMark mark_in(const std::filesystem::path& folder);

/// Returns the mark that lies beside one of a sequence's files, wherever links lead, or at most
/// `folders_above` folders above that.
DataMark mark_of_file(const std::filesystem::path& file, int folders_above);

/// Returns the mark of data that were disturbed once more; the same for an empty text.
DataMark disturbed_by(DataMark mark, const std::string& perturb);

/// Returns the mark of data that were made of both.
DataMark merged(DataMark mark, const DataMark& other);

/// Returns the doubt about such data; empty where they were not disturbed. Each begins alike.
inline constexpr std::string_view kDisturbedDoubt = "disturbed on purpose by ";
std::string disturbed_doubt(const DataMark& mark);

/// Returns the name and the content of the file of a mark that is set.
std::string_view marker_name(const DataMark& mark);
std::string format_mark(const DataMark& mark);
/// Parses the content of either file. Throws DataError.
DataMark parse_mark(std::string_view text, const std::filesystem::path& file);

SimulatedOrigin parse_simulated_origin(std::string_view text, const std::filesystem::path& file);
std::string format_simulated_origin(const SimulatedOrigin& origin);

}  // namespace mosbench
