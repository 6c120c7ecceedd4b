#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "eval/result/result.hpp"

namespace mosbench {

/// Less IoU is not worth the seconds of a decision.
inline constexpr double kWorthADecision = 5e-4;

/// An object over time, about which a person decides whether it moves.
struct TruthTrack {
  std::string sequence;
  std::uint32_t number = 0;  ///< of LabelledScan::objects
  std::size_t first_scan = 0, last_scan = 0;
  std::size_t scans = 0;  ///< in which it was seen
  std::size_t points = 0;
  bool moves = false;  ///< the program's guess
  double doubt = 0;    ///< share of the looks at it that speak against the guess
  double worth = 0;    ///< IoU that a decision is expected to win: lost points times doubt squared
  double chance = 1;   ///< of 0 to 1, drawn at random; the scans and the id fix it

  /// "08/12".
  std::string id() const { return sequence + '/' + std::to_string(number); }
};

/// The tracks of all sequences of a drive, the most worthy first.
struct TrackList {
  std::map<std::string, std::string> fingerprints;  ///< of the frames, by sequence
  std::vector<TruthTrack> tracks;
};

/// Lists the tracks of runs that kept objects, from their files alone. Throws DataError.
TrackList list_tracks(const std::vector<Result>& runs);

/// Parses what `format_tracks` wrote. Throws DataError, also for a track that is there twice.
TrackList parse_tracks(std::string_view text, const std::filesystem::path& file);
std::string format_tracks(const TrackList& list);

}  // namespace mosbench
