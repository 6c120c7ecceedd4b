#pragma once

#include <mosbench/scan.hpp>
#include <optional>
#include <span>

#include "core/base/fields.hpp"

namespace mosbench::tsdf {

/// The settings that methods on truncated signed distances share. The config of a method derives
/// from it. Defaults are those of Dynablox's default.yaml; lengths in voxels are given in metres
/// for voxels of 0.2 m.
struct Config {
  double voxel_size_m = 0.2;
  double min_range_m = 0.5;
  double max_range_m = 20.0;
  int range_image_rows = 0;     ///< V; 0: measured
  int range_image_columns = 0;  ///< H; 0: measured
  double field_of_view_down_deg = 0;
  double field_of_view_up_deg = 0;  ///< both 0: measured
  double truncation_voxels = 2.0;   ///< tau / v
  double max_weight = 1000;
  double map_radius_ranges = 2.0;

  float truncation_m() const { return static_cast<float>(truncation_voxels * voxel_size_m); }
  bool measures_sensor() const {
    return range_image_rows == 0 || range_image_columns == 0 ||
           (field_of_view_down_deg == 0 && field_of_view_up_deg == 0);
  }
};

/// The list of these fields, for the visit_fields of a method's config.
template <typename AnyConfig, typename Visitor>
void visit_common_fields(AnyConfig& config, Visitor&& visit) {
  visit("voxel_size_m", config.voxel_size_m, FieldRange{0.01, 10.0}, "v, edge of a voxel");
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this never move");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "voxels farther than this are not updated");
  visit("range_image_rows", config.range_image_rows, FieldRange{0, 1024},
        "V, rows of the range image; 0: measured in the first scan with 1000 returns, as columns "
        "and field of view");
  visit("range_image_columns", config.range_image_columns, FieldRange{0, 8192},
        "H, columns of the range image in a full turn");
  visit("field_of_view_down_deg", config.field_of_view_down_deg, FieldRange{-90.0, 90.0},
        "elevation of the lowest row; half a row below the lowest beam is best");
  visit("field_of_view_up_deg", config.field_of_view_up_deg, FieldRange{-90.0, 90.0},
        "elevation of the highest row");
  visit("truncation_voxels", config.truncation_voxels, FieldRange{1.1, 100.0},
        "tau, distances are cut off here");
  visit("max_weight", config.max_weight, FieldRange{1.0, 1e6}, "limit of a voxel's weight");
  visit("map_radius_ranges", config.map_radius_ranges, FieldRange{1.0, 1e6},
        "the map is kept within so many times max_range_m; Dynablox keeps all");
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for range limits or a
/// field of view that leave nothing, and a range of too many voxels. The fields must be within
/// their ranges.
void check_common(const Config& config);

/// How a sensor's directions are arranged in rows and columns. Row 0 is the highest; columns run
/// clockwise seen from above. Nothing is seen in the first and the last one, so they should lie
/// where a sensor that does not turn does not look.
struct SensorModel {
  int rows = 0;           ///< V
  int columns = 0;        ///< H, in a full turn
  double down_deg = 0;    ///< elevation of the lowest row
  double up_deg = 0;      ///< elevation of row 0
  double first_deg = 0;   ///< where columns begin, -180 to 180 from x > 0, y = 0 on
  bool has_beams = true;  ///< false: square pixels, as rosettes have no rows

  bool operator==(const SensorModel&) const = default;
  /// Returns the rays that meet a voxel at 1 m, K = (v H / 2 pi) (v V / field of view).
  double rays_per_voxel_at_1m(double voxel_size_m) const;
};

/// Returns the model that is configured; nullopt when anything of it is to be measured.
std::optional<SensorModel> configured_sensor(const Config& config);

/// Returns a model with what is configured, and the rest from the returns of a scan beyond
/// min_range_m; nullopt if these are too few (1000) to tell. Within half a degree of azimuth the
/// elevations of a spinning sensor are a comb: rows have its median spacing, and there are as many
/// columns as the fullest row has returns. If spacings scatter as at random, the sensor has no
/// rows. Then it gets square pixels, wide enough for one return in the mean; the first lies in the
/// middle of where it sees nothing.
std::optional<SensorModel> measured_sensor(std::span<const Point> points, const Config& config);

}  // namespace mosbench::tsdf
