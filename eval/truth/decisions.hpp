#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// What a person says of a track.
enum class Decided : std::uint8_t {
  kMoving,
  kStatic,
  kUnsure,
  kTakenBack,  ///< nothing is said of it any more
  kMade,       ///< an edit makes it
  kUnmade      ///< its edit is taken back, which was the last one
};
inline constexpr std::array<std::string_view, 6> kDecidedNames = {"moving",     "static", "unsure",
                                                                  "taken-back", "made",   "unmade"};

/// Points that become a track of their own: the later part of a track (a cut), what a polygon holds
/// of it (a split), several tracks (a merge), or points of no track within a polygon (paint).
struct TrackEdit {
  std::map<std::uint32_t, std::size_t> takes = {};  ///< points by track; 0: of no track
  std::size_t first_scan = 0, last_scan = 0;
  std::vector<Eigen::Vector2d> corners_m = {};  ///< of the polygon in the map; none: everywhere
  bool operator==(const TrackEdit&) const = default;
};

struct Decision {
  std::string track;  ///< TruthTrack::id
  Decided decided;
  TrackEdit edit = {};  ///< of kMade
  bool operator==(const Decision&) const = default;
};

/// Parses the members of an edit: {"takes": {"12": 345}, "scans": [10, 20], "corners_m": [[x, y],
/// ...]}. Throws JSON's exceptions, and std::invalid_argument.
TrackEdit edit_from(const nlohmann::ordered_json& json);

/// Parses decisions.json, a list in the order in which they were made. Throws DataError.
std::vector<Decision> parse_decisions(std::string_view text, const std::filesystem::path& file);
std::string format_decisions(std::span<const Decision> decisions);

/// Returns what holds of each track by now: the last decision, if it was not taken back. Edits
/// are none.
std::map<std::string, Decided> last_of_each(std::span<const Decision> decisions);

}  // namespace mosbench
