#include "core/methods/dufomap/pipeline.hpp"

#include <utility>

#include "core/base/method_row.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::dufomap {
namespace {

/// Beyond it voxel indices would overflow.
constexpr double kReach_voxels = 1 << 18;
/// Blocks are forgotten once in so many scans.
constexpr std::size_t kForgetScans = 16;

/// Takes the points beyond the range limit out of a scan's points, but not out of its voxels: rays
/// lead there.
void leave_out_far_points(const PosedScan& posed, double max_range_m, VoxelizedScan& scan) {
  for (std::size_t i = 0; i < posed.points.size(); ++i) {
    const Point& p = posed.points[i];
    const Eigen::Vector3d ray = Eigen::Vector3d(p.x, p.y, p.z) - posed.origins.at(i);
    const double x = ray.x(), y = ray.y(), z = ray.z();
    if (!((x * x + y * y) + z * z <= max_range_m * max_range_m)) scan.voxel_of_point[i] = kNoVoxel;
  }
}

}  // namespace

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : SequentialMethod(context, kReach_voxels * checked(config).resolution_m, true),
      config_(config) {}

std::vector<LabelledScan> Pipeline::take(PosedScan& posed, LabelledScan result) {
  const StageRecord record{result.stages, context().cpu_times};
  if (!grid_) grid_ = grid_around(posed.map_from_sensor.translation(), config_.resolution_m);
  VoxelizedScan scan = timed(record, "voxelize", [&] {
    return voxelize(posed.points, posed.map_from_sensor, *grid_, config_.min_range_m,
                    config_.max_range_m, pool(), posed.origins);
  });
  leave_out_far_points(posed, config_.max_range_m, scan);
  std::vector<LabelledScan> results;
  if (config_.when == When::kOnline && result.scan_index > 0) judge(scan, result);
  add_voids(scan, record);
  if (config_.when == When::kFinal) {
    held_.push_back({std::move(scan), std::move(result)});
  } else {
    if (result.scan_index % kForgetScans == 0) forget(scan);
    results.push_back(std::move(result));
  }
  return results;
}

std::vector<LabelledScan> Pipeline::release() {
  std::vector<LabelledScan> results;
  for (HeldScan& held : held_) {
    judge(held.scan, held.result);
    results.push_back(std::move(held.result));
  }
  held_.clear();
  return results;
}

/// Adds what is void in a scan to the map.
void Pipeline::add_voids(const VoxelizedScan& scan, const StageRecord& record) {
  const SeenSpace seen = timed(
      record, "raycast", [&] { return dufomap::see(scan, *grid_, config_, scratch_, pool()); });
  const VoxelList voids = timed(record, "void", [&] {
    return new_voids(seen, ever_void_, config_.pose_error_voxels, pool());
  });
  const StageClock clock(record, "map_update");
  for (std::size_t i = 0; i < voids.blocks.size(); ++i) {
    if (!voids.masks[i].any()) continue;
    const auto [slot, is_new] = ever_void_.find_or_add(voids.blocks[i]);
    ever_void_[slot] = is_new ? voids.masks[i] : ever_void_[slot] | voids.masks[i];
  }
}

void Pipeline::judge(const VoxelizedScan& scan, LabelledScan& result) const {
  const StageClock clock({result.stages, context().cpu_times}, "labels");
  std::vector<std::uint32_t> slots;
  for (const BlockIndex& block : scan.measured.blocks) slots.push_back(ever_void_.find(block));
  for (std::size_t i = 0; i < scan.voxel_of_point.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    const std::uint32_t slot = slots[voxel / kBlockVoxels];
    if (slot == kNoSlot || !ever_void_[slot].test(voxel % kBlockVoxels)) continue;
    result.labels[i] = kMovingLabel;
    if (context().scores) result.scores[i] = 1;
  }
  result.threshold = 0.5;
  result.judged = true;
}

/// Forgets blocks farther than two ranges from the sensor.
void Pipeline::forget(const VoxelizedScan& scan) {
  ever_void_.for_each_slot([&](std::uint32_t slot) {
    const Eigen::Vector3d corner_m = grid_->corner_m(voxel_at(ever_void_.index_of(slot), 0));
    if ((corner_m - scan.sensor_m).norm() > 2 * config_.max_range_m) ever_void_.erase(slot);
  });
}

std::optional<MemoryUse> Pipeline::memory() const {
  std::size_t bytes = scratch_.memory_bytes() + ever_void_.memory_bytes();
  for (const HeldScan& held : held_) {
    bytes += held.scan.memory_bytes() + held.result.labels.capacity() * sizeof(std::uint32_t);
  }
  return MemoryUse{bytes, ever_void_.size()};
}

void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.resolution_m, "resolution_m",
               kMaxRangeVoxels);
  check_voxels("sensor_noise_m", config.sensor_noise_m / config.resolution_m, "resolution_m",
               kMaxRangeVoxels);
}

/// "dufomap": points in space that was void in some scan.
MethodKind method_kind() {
  return {.name = "dufomap",
          .title = "DUFOMap",
          .source =
              "Duberg, Zhang, Jia, Jensfelt: DUFOMap: Efficient Dynamic Awareness Mapping, IEEE "
              "Robotics and Automation Letters 2024, arXiv:2403.01449",
          .summary = "points in space that some scan saw to be void, on a map of one bit per voxel",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "seen void",
          .takes_origins = true};
}

}  // namespace mosbench::dufomap
