#pragma once

#include <array>
#include <string_view>

#include "core/base/fields.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::dufomap {

/// Which map decides: that of the scans before, or the last one (as published: cleaning a map).
enum class When { kOnline, kFinal };
inline constexpr std::array<std::string_view, 2> kWhenNames = {"online", "final"};

/// Every parameter, with the paper's symbol; the defaults are the authors' but for the range limit,
/// which they have not.
struct Config {
  When when = When::kOnline;
  double resolution_m = 0.1;  ///< v; by another name than other methods', whose presets do not fit
  double sensor_noise_m = 0.2;  ///< d_s
  int pose_error_voxels = 1;    ///< d_p
  double min_range_m = 0.2;     ///< points at or nearer than this never take part
  double max_range_m = 50.0;    ///< rays end there, points farther away never move
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("when", config.when, kWhenNames,
        "points are judged by the scans before theirs (online), or by all scans (final, as "
        "published): the whole map and the voxels of all scans are kept");
  visit("resolution_m", config.resolution_m, FieldRange{0.01, 10.0}, "v, edge of a voxel");
  visit("sensor_noise_m", config.sensor_noise_m, FieldRange{0.0, 10.0},
        "d_s, so much of a ray before its end counts as hit");
  visit("pose_error_voxels", config.pose_error_voxels, FieldRange{0, kBlockSide},
        "d_p, a voxel is void when all voxels so near were seen by the same scan");
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never take part");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "rays end here, and points farther than this never move");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, range limits that leave nothing, and a range or d_s of too many voxels.
void check(const Config& config);

}  // namespace mosbench::dufomap
