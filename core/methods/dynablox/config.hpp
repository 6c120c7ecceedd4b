#pragma once

#include <array>
#include <string_view>

#include "core/base/fields.hpp"
#include "core/tsdf/sensor_model.hpp"

namespace mosbench::dynablox {

/// What a point is judged by: the object that it is part of, or its voxel alone.
enum class Level { kObject, kPoint };
inline constexpr std::array<std::string_view, 2> kLevelNames = {"object", "point"};

/// When a new voxel counts as last occupied: before the first scan, as in the authors' program,
/// where a voxel that is seen free at first sight skips the burn-in; or now, as in nvblox.
enum class InitialLastOccupied { kZero, kNow };
inline constexpr std::array<std::string_view, 2> kInitialNames = {"zero", "now"};

/// How boxes of clusters are tested for overlap: the authors compare the lower z with the upper x.
enum class BoxTest { kAuthors, kFixed };
inline constexpr std::array<std::string_view, 2> kBoxTestNames = {"authors", "fixed"};

/// What becomes of points at or nearer than min_range_m: left out, or entered as the authors'
/// program does, so that they occupy the sensor's own voxel.
enum class MissingReturns { kIgnore, kKeep };
inline constexpr std::array<std::string_view, 2> kMissingNames = {"ignore", "keep"};

/// Every parameter; the defaults are those of the authors' default.yaml, where lengths in voxels
/// are given in metres for voxels of 0.2 m.
struct Config : tsdf::Config {
  Level level = Level::kObject;
  double occupied_below_voxels = 1.5;
  int burn_in_scans = 5;
  int temporal_buffer_scans = 2;
  int counter_to_reset_scans = 150;
  InitialLastOccupied initial_last_occupied = InitialLastOccupied::kZero;
  MissingReturns missing_returns = MissingReturns::kIgnore;
  int min_cluster_points = 20;
  int max_cluster_points = 200000;
  double min_cluster_extent_m = 0;
  double max_cluster_extent_m = 200000;
  double cluster_separation_voxels = 1.0;
  BoxTest box_test = BoxTest::kAuthors;
  double max_tracking_distance_m = 1.0;
  int min_track_scans = 0;

  float occupied_below_m() const {
    return static_cast<float>(occupied_below_voxels * voxel_size_m);
  }
};

/// The one list of fields, as fields.hpp describes it.
template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("level", config.level, kLevelNames, "points move with their object, or by their voxel");
  tsdf::visit_common_fields(config, visit);
  visit("occupied_below_voxels", config.occupied_below_voxels, FieldRange{0.0, 100.0},
        "a voxel is occupied below this distance to a surface");
  visit("burn_in_scans", config.burn_in_scans, FieldRange{1, 10000},
        "an ever-free voxel was not occupied for so long");
  visit("temporal_buffer_scans", config.temporal_buffer_scans, FieldRange{0, 10000},
        "longer gaps begin a new run of occupied scans");
  visit("counter_to_reset_scans", config.counter_to_reset_scans, FieldRange{1, 65535},
        "a voxel occupied in so many scans is no longer ever-free");
  visit("initial_last_occupied", config.initial_last_occupied, kInitialNames,
        "when a new voxel was last occupied: zero as the authors' program, or now");
  visit("missing_returns", config.missing_returns, kMissingNames,
        "whether points within min_range_m enter the map, as in the authors' program");
  visit("min_cluster_points", config.min_cluster_points, FieldRange{0, 1000000},
        "an object has at least so many points");
  visit("max_cluster_points", config.max_cluster_points, FieldRange{1, 10000000},
        "an object has at most so many points");
  visit("min_cluster_extent_m", config.min_cluster_extent_m, FieldRange{0.0, 1e6},
        "an object's box has at least this diagonal");
  visit("max_cluster_extent_m", config.max_cluster_extent_m, FieldRange{0.0, 1e6},
        "an object's box has at most this diagonal");
  visit("cluster_separation_voxels", config.cluster_separation_voxels, FieldRange{0.0, 8.0},
        "clusters with voxels this near are one; 0: never");
  visit("box_test", config.box_test, kBoxTestNames,
        "overlap of clusters' boxes as the authors' program tests it, or corrected");
  visit("max_tracking_distance_m", config.max_tracking_distance_m, FieldRange{0.0, 1000.0},
        "an object's centre moves at most so far between scans");
  visit("min_track_scans", config.min_track_scans, FieldRange{0, 10000},
        "an object was seen in so many scans before");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for the first field
/// outside its range, range limits or a field of view that leave nothing, a range of too many
/// voxels, and an occupied distance beyond the truncation.
void check(const Config& config);

}  // namespace mosbench::dynablox
