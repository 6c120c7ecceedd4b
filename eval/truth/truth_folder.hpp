#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "eval/result/result.hpp"
#include "eval/truth/decisions.hpp"
#include "eval/truth/track_list.hpp"

namespace mosbench {

/// The folder of `mosbench truth`: a run that kept objects, tracks.json and decisions.json.
struct TruthFolder {
  std::filesystem::path path;
  std::vector<Result> runs;                ///< by sequence
  std::vector<TruthTrack> tracks;          ///< in the order of `sort_for_decisions`
  std::vector<Decision> decisions;         ///< in order
  std::map<std::string, Decided> decided;  ///< by track

  std::vector<TruthTrack> undecided() const;
  /// The tracks that are decided against more than 0.8 of the looks: a wrong key, most likely.
  std::vector<const TruthTrack*> contradicted() const;
  /// Stores a decision behind those in the file by now. It is on the disk then. Throws DataError.
  void decide(const Decision& decision);
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
