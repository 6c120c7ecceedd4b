#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/sequence_writer.hpp"

namespace mosbench {

struct ConvertOptions {
  DatasetKind layout = DatasetKind::kSemanticKitti;  ///< one that has a writer
  WriteOptions writing = {};
  std::filesystem::path out;  ///< becomes the data set's root
  /// Called with the position of a sequence before its first scan is read, if it is to be written.
  std::function<void(std::size_t sequence)> before_sequence = {};
};

/// Returns whether a conversion to the folder was not finished.
bool is_unfinished_conversion(const std::filesystem::path& root);

/// Returns what a conversion makes of a sequence, as (what, how): its scans, how they are read, and
/// how many are written.
ReadingMembers plan_of(const Sequence& sequence);

/// Writes every frame of a data set in the layout, with the LiDAR's own poses, and for HeLiMOS the
/// splits that the source has. Simulated data stay marked as such. After a kill the same conversion
/// goes on with the first sequence that is not finished. Throws UsageError when `out` holds
/// anything else, the layout is only read, or it has no room for a sequence. `progress` is called
/// with the scans done and to do. Returns what of the truth the layout does not hold, in plain
/// sentences.
std::vector<std::string> convert(
    const Dataset& dataset, const ConvertOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace mosbench
