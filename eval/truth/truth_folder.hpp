#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "eval/result/result.hpp"
#include "eval/truth/decisions.hpp"
#include "eval/truth/track_edits.hpp"
#include "eval/truth/track_list.hpp"

namespace mosbench {

/// The folder of `mosbench truth`: a run that kept objects, tracks.json and decisions.json.
struct TruthFolder {
  std::filesystem::path path;
  std::vector<Result> runs;          ///< by sequence
  std::vector<TruthTrack> proposed;  ///< of tracks.json
  std::vector<Decision> decisions;   ///< in order
  std::vector<MadeTrack> made;       ///< by edits that hold
  std::vector<TruthTrack>
      tracks;  ///< proposed and made that have points, as `sort_for_decisions` orders
  std::map<std::string, Decided> decided;  ///< by track

  std::vector<TruthTrack> undecided() const;
  /// The tracks that are decided against more than 0.8 of the looks: a wrong key, most likely.
  std::vector<const TruthTrack*> contradicted() const;
  /// Stores decisions behind those in the file by now. They are on the disk then. Throws DataError.
  void decide(std::span<const Decision> more);
  /// Stores an edit of a sequence and returns the new track. Throws DataError.
  const TruthTrack& make(const std::string& sequence, TrackEdit edit);

 private:
  friend TruthFolder open_truth(const std::filesystem::path& folder);
  void take(std::vector<Decision> all);
};

std::filesystem::path tracks_file(const std::filesystem::path& folder);
std::filesystem::path decisions_file(const std::filesystem::path& folder);

/// Returns the decisions in a folder, none without their file. Throws DataError.
std::vector<Decision> read_decisions(const std::filesystem::path& folder);

/// "31 decisions left, about 4 min 08 s", of the tracks that are worth one.
std::string left_text(const std::vector<TruthTrack>& undecided);

/// Opens what `mosbench truth propose` wrote. Throws DataError where the tracks are not those of
/// the runs beside them, and for decisions on other tracks.
TruthFolder open_truth(const std::filesystem::path& folder);

}  // namespace mosbench
