#pragma once

#include <array>
#include <string_view>

#include "core/base/fields.hpp"

namespace mosbench::octomap {

/// Which map decides: that of the scans before, the same with the scan itself, or the last one
/// (what is meant by cleaning a map).
enum class When { kBefore, kAfter, kFinal };
inline constexpr std::array<std::string_view, 3> kWhenNames = {"before", "after", "final"};

/// Every parameter; probabilities are the library's defaults. The paper labels no points: `when` is
/// ours.
struct Config {
  When when = When::kBefore;
  double voxel_size_m = 0.20;
  double min_range_m = 0.5;   ///< points at or nearer than this never take part
  double max_range_m = 20.0;  ///< rays are cut there, points farther away never move
  double hit_probability = 0.7;
  double miss_probability = 0.4;
  double lowest_probability = 0.1192;  ///< clamping
  double highest_probability = 0.971;  ///< clamping
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("when", config.when, kWhenNames,
        "points are judged by the map before their scan entered, after it, or at the end (final: "
        "the whole map and the voxels of all scans are kept)");
  visit("voxel_size_m", config.voxel_size_m, FieldRange{0.01, 10.0}, "edge of a voxel");
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never take part");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "rays are cut here, and points farther than this never move");
  visit("hit_probability", config.hit_probability, FieldRange{0.5, 0.999},
        "of a voxel to be occupied where a ray ends");
  visit("miss_probability", config.miss_probability, FieldRange{0.001, 0.5},
        "of a voxel to be occupied that rays cross");
  visit("lowest_probability", config.lowest_probability, FieldRange{0.001, 0.499},
        "occupancies are clamped here");
  visit("highest_probability", config.highest_probability, FieldRange{0.501, 0.999}, "and here");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, range limits that leave nothing, and a range of too many voxels.
void check(const Config& config);

}  // namespace mosbench::octomap
