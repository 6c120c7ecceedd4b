#include "core/tsdf/tsdf_method.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/base/method_row.hpp"
#include "core/base/stage_clock.hpp"
#include "core/tsdf/integration.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::tsdf {
namespace {

/// Returns a grid whose origin is near the first scan, in whole wide blocks of the map frame.
VoxelGrid wide_grid_around(const Eigen::Vector3d& sensor_m, double voxel_size_m) {
  VoxelGrid grid = grid_around(sensor_m, voxel_size_m);
  for (double& origin : grid.origin_voxels) origin = std::floor(origin / kWideSide) * kWideSide;
  return grid;
}

}  // namespace

TsdfMethod::TsdfMethod(const Config& config, const RunContext& context, Wants wants)
    : ScanMethod(context), config_(config), wants_(wants), sensor_(configured_sensor(config)) {}

std::unique_ptr<ObservedScan> TsdfMethod::see(std::span<const Point> points, const Pose& pose,
                                              const RayOrigins& origins, ThreadPool& pool) {
  expect_one_origin(origins);
  auto current = std::make_unique<ObservedScan>();
  const StageRecord record{current->stages, context().cpu_times};
  const VoxelGrid around =
      grid_ ? *grid_ : wide_grid_around(pose.translation(), config_.voxel_size_m);
  current->map_from_sensor = pose;
  current->scan = timed(record, "voxelize", [&] {
    return voxelize(points, pose, around, wants_.nearest_m, config_.max_range_m, pool);
  });
  if (!grid_) grid_ = around;  // written once: the previous scan may be pushed meanwhile
  timed(record, "range_image", [&] { cast(points, *current, pool); });
  if (wants_.points) current->points.assign(points.begin(), points.end());
  return current;
}

void TsdfMethod::cast(std::span<const Point> points, ObservedScan& observed, ThreadPool& pool) {
  if (!sensor_) sensor_ = measured_sensor(points, config_);
  observed.sensor = sensor_;
  if (!sensor_) return;
  const ScanPixels pixels = pixels_of(points, *sensor_, pool);
  observed.image = range_image(pixels, *sensor_, static_cast<float>(config_.min_range_m));
  const RayLimits limits{.wide_block_m = kWideSide * config_.voxel_size_m,
                         .grid_origin_m = grid_->corner_m({0, 0, 0}),
                         .min_range_m = config_.min_range_m,
                         .max_range_m = config_.max_range_m,
                         .beyond_m = config_.truncation_m()};
  observed.wide_blocks =
      ray_blocks(points, pixels, observed.map_from_sensor, limits, scratch_, pool);
}

std::vector<LabelledScan> TsdfMethod::enter(ObservedScan& scan) {
  std::vector<LabelledScan> results(1);
  LabelledScan& result = results.front();
  result.scan_index = k();
  result.nonfinite_points = scan.scan.nonfinite_points;
  result.stages = std::move(scan.stages);
  result.judged = true;
  result.labels.assign(scan.scan.voxel_of_point.size(), kStaticLabel);
  take(scan, result);
  return results;
}

void TsdfMethod::integrate_scan(TsdfMap& map, std::span<const std::uint32_t> slots,
                                const ObservedScan& observed) {
  if (!observed.sensor) return;
  integrate(map, slots, grid(), {observed.image, *observed.sensor, observed.map_from_sensor},
            config_, pool());
}

std::optional<MemoryUse> TsdfMethod::memory() const {
  MemoryUse use = map_memory();
  use.bytes += scratch_.memory_bytes();
  return use;
}

std::vector<std::string> TsdfMethod::remarks() const {
  if (!config_.measures_sensor()) return {};
  if (!sensor_) return {"No scan had enough returns to measure the sensor: no point moves."};
  std::ostringstream text;
  text << "The range image was measured: " << sensor_->rows << " rows from " << sensor_->down_deg
       << " to " << sensor_->up_deg << " degrees, " << sensor_->columns << " columns"
       << (sensor_->has_beams ? "." : "; no beams were found, so pixels are square.");
  return {text.str()};
}

void check_common(const Config& config) {
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
  if (config.range_image_rows == 1 ||
      (config.range_image_columns > 0 && config.range_image_columns < 4)) {
    throw std::invalid_argument(
        "range_image_rows: too small an image, expected at least 2 rows and 4 columns, or 0");
  }
  if (config.field_of_view_down_deg > config.field_of_view_up_deg ||
      (config.field_of_view_down_deg == config.field_of_view_up_deg &&
       config.field_of_view_up_deg != 0)) {
    throw std::invalid_argument(
        "field_of_view_down_deg: not below field_of_view_up_deg, expected down < up, or both 0");
  }
}

}  // namespace mosbench::tsdf
