#pragma once

#include <array>
#include <string_view>

#include "core/base/fields.hpp"

namespace mosbench::yoon {

/// After which step points move.
enum class LastStep { kSeeds, kBoxFilter, kGrowth };
inline constexpr std::array<std::string_view, 3> kLastStepNames = {"seeds", "box-filter", "growth"};

/// Every parameter. The paper's values were not at hand: all are of our reading.
struct Config {
  LastStep last_step = LastStep::kGrowth;
  double min_range_m = 0.5;             ///< points at or nearer than this never take part
  double max_range_m = 20.0;            ///< points farther than this never move
  int window_scans = 10;                ///< n; 10 are 1 s at 10 Hz
  double neighbour_angle_rad = 0.0157;  ///< of free-space queries, and edge of a pixel
  double least_angle_rows = 1.15;       ///< that angle is at least so many spacings of rows
  double free_margin_m = 0.3;           ///< that the reference must see past a point
  double seed_residual_m = 0.3;         ///< of a point without anything near it in the reference
  double planar_share = 0.05;           ///< of the smallest eigenvalue in their sum
  double growth_distance_m = 0.3;       ///< from point to point
  double growth_residual_m = 0.15;      ///< below it a point belongs to what was there before
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("last_step", config.last_step, kLastStepNames,
        "points move that are seeds, that the box filter leaves, or that grow from these");
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never take part");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "points farther than this never move");
  visit("window_scans", config.window_scans, FieldRange{1, 1000},
        "n, scan k is compared with scan k - n; 10 are 1 s at 10 Hz");
  visit("neighbour_angle_rad", config.neighbour_angle_rad, FieldRange{0.002, 0.5},
        "beams this near in bearing and elevation decide whether space was free");
  visit("least_angle_rows", config.least_angle_rows, FieldRange{0.0, 10.0},
        "that angle is at least so many spacings of the sensor's rows, measured in the first scan "
        "with 1000 returns; 0: as set");
  visit("free_margin_m", config.free_margin_m, FieldRange{0.001, 100.0},
        "space is free where all of them reach this much farther");
  visit("seed_residual_m", config.seed_residual_m, FieldRange{0.0, 0.59},
        "a seed is in free space and farther than this from all reference points or their plane");
  visit("planar_share", config.planar_share, FieldRange{0.0, 0.34},
        "ten points are a plane when their smallest eigenvalue is a lesser share of the sum");
  visit("growth_distance_m", config.growth_distance_m, FieldRange{0.01, 5.0},
        "objects grow from point to point this near");
  visit("growth_residual_m", config.growth_residual_m, FieldRange{0.0, 0.59},
        "objects grow only into points farther than this from the reference");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, and range limits that leave nothing.
void check(const Config& config);

}  // namespace mosbench::yoon
