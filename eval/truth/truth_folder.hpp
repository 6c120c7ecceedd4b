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
  std::vector<Result> runs;  ///< by sequence
  std::vector<TruthTrack> tracks;
  std::vector<Decision> decisions;         ///< in order
  std::map<std::string, Decided> decided;  ///< by track

  std::vector<TruthTrack> undecided() const;
};

std::filesystem::path tracks_file(const std::filesystem::path& folder);
std::filesystem::path decisions_file(const std::filesystem::path& folder);

/// Returns the decisions in a folder, none without their file. Throws DataError.
std::vector<Decision> read_decisions(const std::filesystem::path& folder);

/// Opens what `mosbench truth propose` wrote. Throws DataError where the tracks are not those of
/// the runs beside them, and for decisions on other tracks.
TruthFolder open_truth(const std::filesystem::path& folder);

}  // namespace mosbench
