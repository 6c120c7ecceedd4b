#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "eval/answer/answer.hpp"
#include "eval/static_map/map_accuracy.hpp"

namespace mosbench {

/// A cleaned map against the truth of its points, and which files they are.
struct MapScore {
  std::filesystem::path map, truth;
  std::uint64_t map_points = 0;
  double same_within_m = kSameWithin_m;
  MapCounts counts;
};

/// Reads both clouds, in one frame (.pcd or .ply), and compares them.
/// `truth` is the file with intensity 1 for dynamic points and 0 for others, or the folder of one
/// of KTH's sequences, whose gt_cloud.pcd is read. Throws DataError, also for other intensities and
/// for a truth that is empty or not finite, and so far from the origin that float32 is too coarse.
MapScore score_map(const std::filesystem::path& map, const std::filesystem::path& truth,
                   double same_within_m);

/// Says how much of the truth was kept and removed.
Sheet map_score_sheet(const MapScore& score);
/// With the code's version and a hash of each file.
nlohmann::ordered_json map_score_json(const MapScore& score);

}  // namespace mosbench
