#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/base/fields.hpp"
#include "core/tsdf/config.hpp"

namespace mosbench::lc_free_space {

/// What a point is judged by: its voxel and those beside it, or its voxel alone.
enum class Level { kCluster, kPoint };
inline constexpr std::array<std::string_view, 2> kLevelNames = {"cluster", "point"};

/// Every parameter. Those of the map are Dynablox's; the threshold is that of map_lookup.yaml on
/// the branch test of ethz-asl/dynablox, one voxel.
struct Config : tsdf::Config {
  Level level = Level::kCluster;
  double free_above_voxels = 1.0;  ///< theta / v

  float free_above_m() const { return static_cast<float>(free_above_voxels * voxel_size_m); }
  /// Returns the least distance that is free, as d > theta is d >= the next number.
  float least_free_m() const {
    return std::nextafter(free_above_m(), std::numeric_limits<float>::infinity());
  }
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("level", config.level, kLevelNames,
        "points move with a voxel beside theirs, too, or by their own voxel");
  tsdf::visit_common_fields(config, visit);
  visit("free_above_voxels", config.free_above_voxels, FieldRange{0.0, 100.0},
        "theta, a voxel is free beyond this distance to a surface");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, range limits or a field of view that leave nothing, a range of too many
/// voxels, and a threshold that no distance exceeds.
void check(const Config& config);

}  // namespace mosbench::lc_free_space
