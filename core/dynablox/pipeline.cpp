#include "core/dynablox/pipeline.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "core/base/push_order.hpp"
#include "core/base/rigid.hpp"
#include "core/base/stage_clock.hpp"
#include "core/dynablox/clusters.hpp"
#include "core/dynablox/ever_free.hpp"
#include "core/dynablox/integration.hpp"
#include "core/dynablox/range_image.hpp"
#include "core/dynablox/ray_blocks.hpp"
#include "core/dynablox/tracks.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::dynablox {
namespace {

/// What a scan shows without the scans before it.
struct ObservedScan final : NumberedScan {
  std::vector<Point> points;  ///< of objects, whose centres are asked for
  Pose map_from_sensor = Pose::Identity();
  VoxelizedScan scan;
  std::optional<SensorModel> sensor;  ///< not known while scans have too few returns to measure it
  RangeImage image;
  std::vector<BlockIndex> wide_blocks;  ///< on the rays
  std::vector<StageTime> stages;
};

/// Returns a grid whose origin is near the first scan, in whole wide blocks of the map frame.
VoxelGrid wide_grid_around(const Eigen::Vector3d& sensor_m, double voxel_size_m) {
  VoxelGrid grid = grid_around(sensor_m, voxel_size_m);
  for (double& origin : grid.origin_voxels) origin = std::floor(origin / kWideSide) * kWideSide;
  return grid;
}

}  // namespace

struct Pipeline::State {
  State(const Config& method_config, const RunContext& run)
      : config(method_config),
        context(checked(run)),
        order(context.scan_count),
        pool(context.threads),
        sensor(configured_sensor(config)),
        tracks(config.max_tracking_distance_m) {}

  std::unique_ptr<ObservedScan> observe(std::span<const Point> points, const Pose& pose,
                                        ThreadPool& observing);
  LabelledScan push(ObservedScan& observed);
  void label_points(const ObservedScan& observed, std::span<const BlockMask> ever_free,
                    LabelledScan& result);
  void label_objects(const ObservedScan& observed, std::span<const BlockMask> ever_free,
                     LabelledScan& result);
  std::vector<float> scores(const ObservedScan& observed) const;
  void keep_near(const Eigen::Vector3d& sensor_m);

  Config config;
  RunContext context;
  PushOrder order;
  ThreadPool pool;
  std::optional<ThreadPool> observing_pool;  ///< for scans observed during a push
  std::optional<VoxelGrid> grid;             ///< around the first scan
  std::optional<SensorModel> sensor;
  RayBlocksScratch scratch;
  TsdfMap map;
  Tracks tracks;
  std::optional<Eigen::Vector3d> kept_around_m;
};

std::unique_ptr<ObservedScan> Pipeline::State::observe(std::span<const Point> points,
                                                       const Pose& pose, ThreadPool& observing) {
  check_rigid(pose);
  auto current = std::make_unique<ObservedScan>();
  const StageRecord record{current->stages, context.cpu_times};
  const VoxelGrid around = grid ? *grid : wide_grid_around(pose.translation(), config.voxel_size_m);
  const bool keeps = config.missing_returns == MissingReturns::kKeep;
  current->map_from_sensor = pose;
  current->scan = timed(record, "voxelize", [&] {
    return voxelize(points, pose, around, keeps ? -1.0 : config.min_range_m, config.max_range_m,
                    observing);
  });
  if (!grid) grid = around;  // written once: the previous scan may be pushed meanwhile
  {
    const StageClock clock(record, "range_image");
    if (!sensor) sensor = measured_sensor(points, config);
    current->sensor = sensor;
    if (config.level == Level::kObject) current->points.assign(points.begin(), points.end());
    if (sensor) {
      const ScanPixels pixels = pixels_of(points, *sensor, observing);
      current->image = range_image(pixels, *sensor, static_cast<float>(config.min_range_m));
      const RayLimits limits{.wide_block_m = kWideSide * config.voxel_size_m,
                             .grid_origin_m = around.corner_m({0, 0, 0}),
                             .min_range_m = config.min_range_m,
                             .max_range_m = config.max_range_m,
                             .beyond_m = config.truncation_m()};
      current->wide_blocks = ray_blocks(points, pixels, pose, limits, scratch, observing);
    }
  }
  order.number(*current);
  return current;
}

void Pipeline::State::label_points(const ObservedScan& observed,
                                   std::span<const BlockMask> ever_free, LabelledScan& result) {
  for (std::size_t i = 0; i < result.labels.size(); ++i) {
    const std::uint32_t voxel = observed.scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    if (ever_free[voxel / kBlockVoxels].test(voxel % kBlockVoxels)) result.labels[i] = kMovingLabel;
  }
}

void Pipeline::State::label_objects(const ObservedScan& observed,
                                    std::span<const BlockMask> ever_free, LabelledScan& result) {
  const Clusters found = find_clusters(observed.scan, ever_free, *grid, config);
  std::vector<Eigen::Vector3d> centres_m(found.clusters.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < found.of_point.size(); ++i) {
    if (found.of_point[i] == kNoCluster) continue;
    const Point& p = observed.points[i];
    centres_m[found.of_point[i]] += Eigen::Vector3d(p.x, p.y, p.z);
  }
  for (std::size_t i = 0; i < centres_m.size(); ++i) {
    centres_m[i] =
        observed.map_from_sensor * (centres_m[i] / static_cast<double>(found.clusters[i].points));
  }
  const std::vector<Tracks::Track> followed = tracks.follow(centres_m);
  result.objects.assign(result.labels.size(), 0);
  for (std::size_t i = 0; i < found.of_point.size(); ++i) {
    if (found.of_point[i] == kNoCluster) continue;
    const Tracks::Track& track = followed[found.of_point[i]];
    if (track.scans < static_cast<std::uint32_t>(config.min_track_scans)) continue;
    result.labels[i] = kMovingLabel;
    result.objects[i] = track.number;
  }
}

std::vector<float> Pipeline::State::scores(const ObservedScan& observed) const {
  const VoxelizedScan& scan = observed.scan;
  std::vector<const MapBlock*> blocks;
  for (const BlockIndex& index : scan.measured.blocks) blocks.push_back(map.find(index));
  std::vector<float> result(scan.voxel_of_point.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    const MapBlock* block = blocks[voxel / kBlockVoxels];
    if (block == nullptr || block->numbers == kNoSlot) continue;
    const std::uint32_t cell = voxel % kBlockVoxels;
    result[i] = map.numbers[block->numbers].distances_m[cell] +
                (block->ever_free.test(cell) ? config.truncation_m() : 0.0F);
  }
  return result;
}

void Pipeline::State::keep_near(const Eigen::Vector3d& sensor_m) {
  // Looks at the whole map, so not in every scan.
  const double wide_block_m = kWideSide * config.voxel_size_m;
  if (kept_around_m && (*kept_around_m - sensor_m).norm() < wide_block_m) return;
  kept_around_m = sensor_m;
  // Blocks of this scan end no farther than this beyond the range.
  const double beyond_m = config.truncation_m() + 2 * wide_block_m;
  map.keep_within(config.map_radius_ranges * config.max_range_m + beyond_m, *grid, sensor_m);
}

LabelledScan Pipeline::State::push(ObservedScan& observed) {
  const auto frame = static_cast<std::int32_t>(order.pushed() + 1);
  LabelledScan result;
  result.scan_index = order.pushed();
  order.take<ObservedScan>(&observed);
  result.nonfinite_points = observed.scan.nonfinite_points;
  result.stages = std::move(observed.stages);
  result.judged = true;
  result.labels.assign(observed.scan.voxel_of_point.size(), kStaticLabel);
  const StageRecord record{result.stages, context.cpu_times};
  {
    const StageClock clock(record, "clusters");
    std::vector<BlockMask> ever_free;
    for (std::size_t slot = 0; slot < observed.scan.measured.block_count(); ++slot) {
      ever_free.push_back(map.ever_free_in(observed.scan.measured.blocks[slot]) &
                          observed.scan.measured.masks[slot]);
    }
    if (context.scores) result.scores = scores(observed);
    if (config.level == Level::kPoint) {
      label_points(observed, ever_free, result);
    } else {
      label_objects(observed, ever_free, result);
    }
  }
  {
    const StageClock clock(record, "ever_free");
    update_ever_free(map, observed.scan.measured, frame, config, pool);
  }
  {
    const StageClock clock(record, "integrate");
    const bool starts_now = config.initial_last_occupied == InitialLastOccupied::kNow;
    map.touched = map.touch(observed.wide_blocks, starts_now ? frame : 0);
    if (observed.sensor) {
      integrate(map, map.touched, *grid,
                {observed.image, *observed.sensor, observed.map_from_sensor}, config, pool);
    }
  }
  const StageClock clock(record, "evict");
  keep_near(observed.scan.sensor_m);
  return result;
}

Pipeline::Pipeline(const Config& config, const RunContext& context) {
  check(config);
  state_ = std::make_unique<State>(config, context);
}

Pipeline::~Pipeline() = default;

std::unique_ptr<Observed> Pipeline::observe(std::span<const Point> points,
                                            const Pose& map_from_sensor) {
  // The other half of the threads pushes the previous scan.
  if (!state_->observing_pool)
    state_->observing_pool.emplace(std::max(1U, state_->pool.size() / 2));
  return state_->observe(points, map_from_sensor, *state_->observing_pool);
}

std::vector<LabelledScan> Pipeline::push(std::unique_ptr<Observed> observed) {
  auto* scan = dynamic_cast<ObservedScan*>(observed.get());
  if (scan == nullptr) throw std::logic_error("pushed a scan that this pipeline did not observe");
  std::vector<LabelledScan> results;
  results.push_back(state_->push(*scan));
  return results;
}

std::vector<LabelledScan> Pipeline::push(std::span<const Point> points,
                                         const Pose& map_from_sensor) {
  state_->order.expect_scan();
  std::vector<LabelledScan> results;
  results.push_back(state_->push(*state_->observe(points, map_from_sensor, state_->pool)));
  return results;
}

std::vector<LabelledScan> Pipeline::finish() {
  state_->order.finish();
  return {};
}

std::optional<MemoryUse> Pipeline::memory() const {
  return MemoryUse{state_->map.memory_bytes() + state_->scratch.memory_bytes(),
                   state_->map.blocks.size()};
}

std::vector<std::string> Pipeline::remarks() const {
  if (!state_->config.measures_sensor()) return {};
  if (!state_->sensor) return {"No scan had enough returns to measure the sensor: no point moves."};
  const SensorModel& sensor = *state_->sensor;
  std::ostringstream text;
  text << "The range image was measured: " << sensor.rows << " rows from " << sensor.down_deg
       << " to " << sensor.up_deg << " degrees, " << sensor.columns << " columns"
       << (sensor.has_beams ? "." : "; no beams were found, so pixels are 1 degree wide.");
  return {text.str()};
}

}  // namespace mosbench::dynablox
