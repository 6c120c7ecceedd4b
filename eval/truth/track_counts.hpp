#pragma once

#include <filesystem>
#include <optional>

#include "eval/truth/sampled_iou.hpp"
#include "eval/truth/truth_folder.hpp"

namespace mosbench {

/// Counts the points of tracks in the labels that `mosbench truth write` would write.
TrackCounts counts_of_written(const TruthFolder& truth);

/// Counts the points of tracks in the labels of a result on the same scans. What `completed_by`
/// adds to a track is part of it. Reads all scans, where they were or at `data`. Throws DataError.
TrackCounts counts_of_result(const TruthFolder& truth, const ResultSet& result,
                             const std::optional<std::filesystem::path>& data);

}  // namespace mosbench
