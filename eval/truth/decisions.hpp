#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
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
  kTakenBack  ///< nothing is said of it any more
};
inline constexpr std::array<std::string_view, 4> kDecidedNames = {"moving", "static", "unsure",
                                                                  "taken-back"};

struct Decision {
  std::string track;  ///< TruthTrack::id
  Decided decided;
  bool operator==(const Decision&) const = default;
};

/// Parses decisions.json, a list in the order in which they were made. Throws DataError.
std::vector<Decision> parse_decisions(std::string_view text, const std::filesystem::path& file);
std::string format_decisions(std::span<const Decision> decisions);

/// Returns what holds of each track by now: the last decision, if it was not taken back.
std::map<std::string, Decided> last_of_each(std::span<const Decision> decisions);

}  // namespace mosbench
