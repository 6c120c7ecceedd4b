#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/truth/truth_folder.hpp"

namespace mosbench {

/// Where the labels of a sequence come from, in points.
struct TruthShares {
  std::string sequence;
  std::size_t scans = 0, points = 0;
  std::size_t moving = 0, unsure = 0;
  std::size_t by_hand = 0;    ///< of tracks that were decided
  std::size_t completed = 0;  ///< beside objects, see `completed_by`
  std::size_t guessed = 0;    ///< of tracks that nobody looked at; the rest is static of no track
};

/// Writes labels/<stem>.label for each scan into out/<sequence>, 0 unsure, 9 static and 251 moving,
/// and labels/truth.json, which says where they come from. `labels` appears as a whole. Reads the
/// scans where they were, or at `data`. Throws DataError for other scans, UsageError where labels
/// of others would be replaced.
std::vector<TruthShares> write_truth(const TruthFolder& truth,
                                     const std::optional<std::filesystem::path>& data,
                                     const std::filesystem::path& out);

/// What labels that somebody corrected said.
struct TruthImport {
  std::size_t decisions = 0;     ///< on tracks that most of their points contradict
  std::size_t points = 0;        ///< of all labels
  std::size_t still_differ = 0;  ///< from what `write_truth` would write after these decisions
};

/// Decides on tracks by the labels in `corrected`/<sequence>/labels, in any format that is truth,
/// wherever more than half of the points of a track are not as it is decided or guessed; id 0 says
/// nothing. Throws as `write_truth`, and DataError for a scan without labels, or for labels of
/// other points.
TruthImport import_truth(TruthFolder& truth, const std::optional<std::filesystem::path>& data,
                         const std::filesystem::path& corrected);

}  // namespace mosbench
