#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "eval/answer/answer.hpp"

namespace mosbench {

/// How far a point of the truth may be from a point of the map that stands for it: the distance of
/// KTH's DynamicMap_Benchmark, half of the voxels that most methods have.
inline constexpr double kSameWithin_m = 0.05;

/// How much of the points with known truth a cleaned map holds.
struct MapCounts {
  std::uint64_t static_points = 0, kept_static = 0;
  std::uint64_t dynamic_points = 0, removed_dynamic = 0;

  std::optional<double> static_accuracy() const;   ///< SA, 0 to 1; nothing without static points
  std::optional<double> dynamic_accuracy() const;  ///< DA, 0 to 1; nothing without dynamic points
  std::optional<double> associated_accuracy() const;  ///< AA, sqrt(SA * DA)
  std::optional<double> harmonic_accuracy() const;    ///< HA, 2 SA DA / (SA + DA); 0 where both are
};

/// Compares a cleaned map with the points that it was made of (Zhang et al., ITSC 2023). A point of
/// the truth is kept if the map has one within `same_within_m`; the distance is rounded to float32
/// as in the authors' program. `dynamic` says which points of the truth are dynamic. Points of the
/// map that are not finite are left out.
MapCounts count_kept(std::span<const Point> map, std::span<const Point> truth,
                     const std::vector<bool>& dynamic, double same_within_m = kSameWithin_m);

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
