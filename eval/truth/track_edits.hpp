#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "eval/truth/decisions.hpp"
#include "eval/truth/track_list.hpp"

namespace mosbench {

/// A track that a person made out of the points of others, or of none.
struct MadeTrack {
  std::string sequence;
  std::uint32_t number = 0;
  TrackEdit edit;
};

/// Returns a number that no track of the sequence has or had.
std::uint32_t new_number(std::span<const TruthTrack> proposed, std::span<const Decision> decisions,
                         const std::string& sequence);

/// Returns the edits that hold, in order. Throws DataError for decisions on tracks that are not
/// there, and where another edit than the last one is taken back: later ones stand on it.
std::vector<MadeTrack> made_by(std::span<const Decision> decisions,
                               std::span<const TruthTrack> proposed,
                               const std::filesystem::path& file);

/// Returns the tracks after edits, the most worthy first, without those that lost all points. A new
/// one has the guess of the track that gave it most points, and paint that of what is no track:
/// static, with half a doubt. Throws DataError where more points are taken than a track has.
std::vector<TruthTrack> edited(std::vector<TruthTrack> tracks, std::span<const MadeTrack> made,
                               const std::filesystem::path& file);

/// Gives the points of a scan to the tracks that edits made. `objects` holds the track of each
/// point. Paint leaves out what is less than 0.1 m above the lowest point around, the ground.
void apply_edits(std::span<const MadeTrack> made, const std::string& sequence,
                 std::size_t scan_index, std::span<const Eigen::Vector3d> positions_map_m,
                 std::span<std::uint32_t> objects);

}  // namespace mosbench
