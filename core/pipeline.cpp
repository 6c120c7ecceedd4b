#include "core/pipeline.hpp"

#include <chrono>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "core/convolution.hpp"
#include "core/dynamic_region.hpp"
#include "core/label_projection.hpp"
#include "core/local_window.hpp"
#include "core/median.hpp"
#include "core/raycast.hpp"
#include "core/selection.hpp"
#include "core/voxel_map.hpp"
#include "core/voxelize.hpp"

namespace mosbench {
namespace {

/// Adds the wall time of its life to a stage.
class StageClock {
 public:
  StageClock(StageTimes& times, Stage stage)
      : time_ms_(times[static_cast<std::size_t>(stage)]),
        start_(std::chrono::steady_clock::now()) {}
  ~StageClock() {
    time_ms_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
                    .count();
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  double& time_ms_;
  std::chrono::steady_clock::time_point start_;
};

/// Runs one stage and returns its value.
template <typename Work>
auto timed(StageTimes& times, Stage stage, Work&& work) {
  const StageClock clock(times, stage);
  return work();
}

/// Whole blocks near the first sensor position, so that voxel indices stay small.
VoxelGrid grid_around(const Eigen::Vector3d& sensor_m, double voxel_size_m) {
  VoxelGrid grid{.voxel_size_m = voxel_size_m};
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin_voxels[axis] = std::floor(sensor_m[axis] / voxel_size_m / kBlockSide) * kBlockSide;
  }
  return grid;
}

/// What the method remembers between scans.
struct Memory {
  Memory(const Config& config, Variant variant, const VoxelGrid& voxel_grid)
      : grid(voxel_grid),
        map(config, variant, grid),
        window(config.local_window_scans),
        region(grid, config.max_range_m, config.dynamic_window_scans, config.min_otsu_score) {}

  VoxelGrid grid;
  VoxelMap map;
  LocalWindow window;
  DynamicRegion region;
  VoxelSet carried;  ///< dynamic voxels of the previous detection
};

/// A scan whose labels are not final yet.
struct HeldScan {
  VoxelizedScan scan;
  ScanResult result;
};

}  // namespace

struct Pipeline::State {
  State(const Config& method_config, Variant method_variant, unsigned threads,
        std::optional<std::size_t> sequence_scans)
      : config(method_config), variant(method_variant), pool(threads), scan_count(sequence_scans) {}

  void observe(HeldScan& current, std::uint32_t k);
  void detect(const VoxelizedScan& scan, std::uint32_t k, ScanResult& result, StageTimes& times);
  std::vector<ScanResult> release(std::size_t count);

  Config config;
  Variant variant;
  ThreadPool pool;
  std::optional<std::size_t> scan_count;
  RaycastScratch scratch;
  std::optional<Memory> memory;
  std::deque<HeldScan> held;  ///< the last delay + 1 scans, current one last
  VoxelSet previous_measured;
  std::size_t pushed = 0;
  bool finished = false;
};

/// Steps 1 to 3: the scan enters the map.
void Pipeline::State::observe(HeldScan& current, std::uint32_t k) {
  StageTimes& times = current.result.stage_times;
  const VoxelizedScan& scan = current.scan;
  const ObservedVoxels observed = timed(times, Stage::kRaycast, [&] {
    return raycast(scan.measured, scan.sensor_voxel, config.voxel_size_m, config.max_range_m,
                   scratch, pool);
  });
  {
    const StageClock clock(times, Stage::kMapUpdate);
    std::vector<const VoxelSet*> sources{&scan.measured};
    if (config.distance_field_scans == 2) sources.push_back(&previous_measured);
    memory->map.update(observed, sources, scan.sensor_m, k, pool);
  }
  const StageClock clock(times, Stage::kEvict);
  memory->map.evict(k);
}

/// Steps 5 and 6 on `scan` with the map as it is after scan k.
void Pipeline::State::detect(const VoxelizedScan& scan, std::uint32_t k, ScanResult& result,
                             StageTimes& times) {
  LocalWindow& window = memory->window;
  DynamicRegion& region = memory->region;
  result.threshold.reset();
  if (scan.occupied_count == 0) {
    window.join({});
    result.labels.assign(scan.voxel_of_point.size(), kStaticLabel);
    return;
  }
  const int width = config.kernel_width_voxels;
  ScoreField scores = timed(times, Stage::kConvolution, [&] {
    const VoxelSet changed =
        memory->map.changed_since(k - static_cast<std::uint32_t>(config.delay_scans));
    return convolve(scan, changed, width, memory->map, k, pool);
  });
  scores = timed(times, Stage::kMedian, [&] { return median_filter(scan, scores, pool); });
  const SumField sums = timed(times, Stage::kWindow, [&] {
    window.join(std::move(scores));
    return window.sums(scan);
  });
  VoxelSet& dynamic = memory->carried;
  {
    const StageClock clock(times, Stage::kOtsu);
    result.threshold = threshold_of(scan, sums);
    dynamic = select_dynamic(scan, sums, result.threshold, dynamic, config.min_otsu_score);
  }
  const double threshold = result.threshold.value_or(0.0);
  VoxelSet from_region;
  if (variant == Variant::kPaper2024) {
    const StageClock clock(times, Stage::kDynamicRegion);
    std::vector<BlockIndex> asked = region.blocks();
    asked.insert(asked.end(), dynamic.blocks.begin(), dynamic.blocks.end());
    const std::vector<std::uint32_t> slots = slots_around(scan, asked);
    const std::vector<BlockMask> masks =
        mosbench::beside_unknown(scan, slots, width, memory->map, k, pool);
    VoxelSet beside;
    for (std::size_t i = 0; i < slots.size(); ++i) {
      beside.masks[beside.insert(scan.measured.blocks[slots[i]])] = masks[i];
    }
    from_region = region.back_end(scan, beside, width, pool);
    region.update({scan, dynamic, from_region, beside, threshold}, k);
  }
  const StageClock clock(times, Stage::kLabels);
  VoxelSet moving;
  if (threshold > config.min_otsu_score) {
    moving = dynamic;
    for (std::size_t i = 0; i < from_region.block_count(); ++i) {
      BlockMask& mask = moving.masks[moving.insert(from_region.blocks[i])];
      mask = mask | from_region.masks[i];
    }
  }
  result.labels = project_labels(scan, moving);
}

std::vector<ScanResult> Pipeline::State::release(std::size_t count) {
  std::vector<ScanResult> results;
  for (; count > 0; --count) {
    results.push_back(std::move(held.front().result));
    held.pop_front();
  }
  return results;
}

Pipeline::Pipeline(const Config& config, Variant variant, unsigned threads,
                   std::optional<std::size_t> scan_count) {
  check(config);
  if (variant == Variant::kRelease2025 && config.delay_scans != 0) {
    throw std::invalid_argument("delay_scans: " + std::to_string(config.delay_scans) +
                                " in release-2025, which has no delay, expected 0");
  }
  if (threads == 0) throw std::invalid_argument("threads: 0, expected at least 1");
  state_ = std::make_unique<State>(config, variant, threads, scan_count);
}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

std::vector<ScanResult> Pipeline::push(std::span<const Point> points, const Pose& map_from_sensor) {
  State& s = *state_;
  if (s.scan_count && s.pushed >= *s.scan_count) {
    throw std::logic_error("pushed more scans than scan_count announced");
  }
  if (s.finished) throw std::logic_error("pushed a scan after finish");
  const VoxelGrid grid =
      s.memory ? s.memory->grid : grid_around(map_from_sensor.translation(), s.config.voxel_size_m);
  HeldScan current;
  current.result.scan_index = s.pushed;
  current.scan = timed(current.result.stage_times, Stage::kVoxelize, [&] {
    return voxelize(points, map_from_sensor, grid, s.config.min_range_m, s.config.max_range_m,
                    s.pool);
  });
  if (!s.memory) s.memory.emplace(s.config, s.variant, grid);
  current.result.nonfinite_points = current.scan.nonfinite_points;
  const auto k = static_cast<std::uint32_t>(s.pushed);
  s.observe(current, k);
  s.previous_measured = current.scan.measured;
  s.held.push_back(std::move(current));
  ++s.pushed;

  HeldScan& newest = s.held.back();
  StageTimes& times = newest.result.stage_times;
  newest.result.labels.assign(points.size(), kStaticLabel);
  const auto n = static_cast<std::size_t>(s.config.delay_scans);
  if (k <= static_cast<std::uint32_t>(s.config.local_window_scans)) {
    s.memory->window.join({});
  } else if (n == 0) {
    s.detect(newest.scan, k, newest.result, times);
  } else if (k > n) {
    s.detect(s.held.front().scan, k, s.held.front().result, times);
    // The authors' program labels the end of a delayed sequence online, and leaves scan N - n
    // static.
    if (s.scan_count && k + n > *s.scan_count) s.detect(newest.scan, k, newest.result, times);
  }
  return s.held.size() > n ? s.release(1) : std::vector<ScanResult>{};
}

std::vector<ScanResult> Pipeline::finish() {
  state_->finished = true;
  return state_->release(state_->held.size());
}

std::size_t Pipeline::map_blocks() const {
  return state_->memory ? state_->memory->map.block_count() : 0;
}

std::size_t Pipeline::memory_bytes() const {
  if (!state_->memory) return 0;
  const Memory& memory = *state_->memory;
  return memory.map.memory_bytes() + memory.window.memory_bytes() + memory.region.memory_bytes();
}

}  // namespace mosbench
