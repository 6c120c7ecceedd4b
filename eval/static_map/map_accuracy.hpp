#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

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

}  // namespace mosbench
