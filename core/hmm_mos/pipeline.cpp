#include "core/hmm_mos/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <stdexcept>

#include "core/hmm_mos/convolution.hpp"
#include "core/hmm_mos/dynamic_region.hpp"
#include "core/hmm_mos/label_projection.hpp"
#include "core/hmm_mos/local_window.hpp"
#include "core/hmm_mos/median.hpp"
#include "core/hmm_mos/selection.hpp"
#include "core/hmm_mos/voxel_map.hpp"
#include "core/voxel/raycast.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench {
namespace {

/// Where the times of a scan's stages go.
struct StageRecord {
  StageTimes& times;
  std::vector<StageEvent>* events;  ///< may be null
};

/// Adds the time of its life to a stage.
class StageClock {
 public:
  StageClock(const StageRecord& record, Stage stage)
      : record_(record),
        event_{stage, std::chrono::steady_clock::now(), 0,
               record.events != nullptr ? process_cpu_ms() : 0} {}
  ~StageClock() {
    const auto life = std::chrono::steady_clock::now() - event_.start;
    event_.wall_ms = std::chrono::duration<double, std::milli>(life).count();
    record_.times[static_cast<std::size_t>(event_.stage)] += event_.wall_ms;
    if (record_.events == nullptr) return;
    event_.cpu_ms = process_cpu_ms() - event_.cpu_ms;
    record_.events->push_back(event_);
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

 private:
  StageRecord record_;
  StageEvent event_;
};

/// Runs one stage and returns its value.
template <typename Work>
auto timed(const StageRecord& record, Stage stage, Work&& work) {
  const StageClock clock(record, stage);
  return work();
}

/// What the method remembers between scans.
struct Memory {
  Memory(const Config& config, Variant variant, const VoxelGrid& grid)
      : map(config, variant, grid),
        window(config.local_window_scans),
        region(grid, config.max_range_m, config.dynamic_window_scans, config.min_otsu_score) {}

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

  ObservedScan observe(std::span<const Point> points, const Pose& map_from_sensor,
                       ThreadPool& observing);
  std::vector<ScanResult> push(ObservedScan observed);
  void expect_scan() const;
  void enter_map(const ObservedScan& current, const StageRecord& record, std::uint32_t k);
  void detect(const VoxelizedScan& scan, std::uint32_t k, ScanResult& result,
              const StageRecord& record);
  std::vector<ScanResult> release(std::size_t count);
  std::size_t memory_bytes() const;

  Config config;
  Variant variant;
  ThreadPool pool;
  std::optional<ThreadPool> observing_pool;  ///< for scans that are observed beside
  std::optional<std::size_t> scan_count;
  std::optional<VoxelGrid> grid;  ///< around the first scan
  RaycastScratch scratch;
  std::optional<Memory> memory;
  std::deque<HeldScan> held;  ///< the last delay + 1 scans, current one last
  VoxelSet previous_measured;
  std::vector<StageEvent>* events = nullptr;
  bool records_scores = false;
  std::size_t pushed = 0;
  bool finished = false;
};

/// Steps 1 and 2.
ObservedScan Pipeline::State::observe(std::span<const Point> points, const Pose& map_from_sensor,
                                      ThreadPool& observing) {
  ObservedScan current;
  const StageRecord record{current.stage_times, events == nullptr ? nullptr : &current.events};
  const VoxelGrid around =
      grid ? *grid : grid_around(map_from_sensor.translation(), config.voxel_size_m);
  current.scan = timed(record, Stage::kVoxelize, [&] {
    return voxelize(points, map_from_sensor, around, config.min_range_m, config.max_range_m,
                    observing);
  });
  if (!grid) grid = around;  // written once: the scan before may be pushed meanwhile
  current.observed = timed(record, Stage::kRaycast, [&] {
    return raycast(current.scan.measured, current.scan.sensor_voxel, config.voxel_size_m,
                   config.max_range_m, scratch, observing);
  });
  return current;
}

/// Step 3.
void Pipeline::State::enter_map(const ObservedScan& current, const StageRecord& record,
                                std::uint32_t k) {
  const VoxelizedScan& scan = current.scan;
  if (!memory) memory.emplace(config, variant, *grid);
  {
    const StageClock clock(record, Stage::kMapUpdate);
    std::vector<const VoxelSet*> sources{&scan.measured};
    if (config.distance_field_scans == 2) sources.push_back(&previous_measured);
    memory->map.update(current.observed, sources, scan.sensor_m, k, pool);
  }
  const StageClock clock(record, Stage::kEvict);
  memory->map.evict(k);
}

/// Steps 5 and 6 on `scan` with the map as it is after scan k.
void Pipeline::State::detect(const VoxelizedScan& scan, std::uint32_t k, ScanResult& result,
                             const StageRecord& record) {
  LocalWindow& window = memory->window;
  DynamicRegion& region = memory->region;
  result.threshold.reset();
  if (scan.occupied_count == 0) {
    window.join({});
    return;
  }
  const int width = config.kernel_width_voxels;
  ScoreField scores = timed(record, Stage::kConvolution, [&] {
    const VoxelSet changed =
        memory->map.changed_since(k - static_cast<std::uint32_t>(config.delay_scans));
    return convolve(scan, changed, width, memory->map, k, pool);
  });
  scores = timed(record, Stage::kMedian, [&] { return median_filter(scan, scores, pool); });
  const SumField sums = timed(record, Stage::kWindow, [&] {
    window.join(std::move(scores));
    return window.sums(scan);
  });
  VoxelSet& dynamic = memory->carried;
  {
    const StageClock clock(record, Stage::kOtsu);
    result.threshold = threshold_of(scan, sums);
    dynamic = select_dynamic(scan, sums, result.threshold, dynamic, config.min_otsu_score);
  }
  VoxelSet from_region;
  if (variant == Variant::kPaper2024) {
    const StageClock clock(record, Stage::kDynamicRegion);
    const VoxelSet beside =
        beside_unknown(scan, region.blocks(), dynamic.blocks, width, memory->map, k, pool);
    from_region = region.back_end(scan, beside, width, pool);
    region.update({scan, dynamic, from_region, beside, result.threshold}, k);
  }
  const StageClock clock(record, Stage::kLabels);
  const VoxelSet moving = shows_motion(result.threshold, config.min_otsu_score)
                              ? united(dynamic, from_region)
                              : VoxelSet{};
  result.labels = project_labels(scan, moving);
  if (records_scores) result.scores = project_scores(scan, sums);
}

void Pipeline::State::expect_scan() const {
  if (scan_count && pushed >= *scan_count) {
    throw std::logic_error("pushed more scans than scan_count announced");
  }
  if (finished) throw std::logic_error("pushed a scan after finish");
}

std::vector<ScanResult> Pipeline::State::push(ObservedScan observed) {
  expect_scan();
  if (!grid) throw std::logic_error("pushed a scan that this pipeline did not observe");
  const auto k = static_cast<std::uint32_t>(pushed);
  ScanResult taken_in;
  taken_in.scan_index = pushed;
  taken_in.nonfinite_points = observed.scan.nonfinite_points;
  taken_in.stage_times = observed.stage_times;
  if (events != nullptr)
    events->insert(events->end(), observed.events.begin(), observed.events.end());
  enter_map(observed, {taken_in.stage_times, events}, k);
  previous_measured = observed.scan.measured;
  held.push_back({std::move(observed.scan), std::move(taken_in)});
  ++pushed;

  HeldScan& newest = held.back();
  const StageRecord record{newest.result.stage_times, events};
  const auto n = static_cast<std::size_t>(config.delay_scans);
  if (k <= static_cast<std::uint32_t>(config.local_window_scans)) {
    memory->window.join({});
  } else if (n == 0) {
    detect(newest.scan, k, newest.result, record);
  } else if (k > n) {
    detect(held.front().scan, k, held.front().result, record);
    // The authors' program labels the end of a delayed sequence online, and leaves scan N - n
    // static.
    if (scan_count && k + n > *scan_count) detect(newest.scan, k, newest.result, record);
  }
  return held.size() > n ? release(1) : std::vector<ScanResult>{};
}

/// Points of a scan in which nothing was looked for are static.
std::vector<ScanResult> Pipeline::State::release(std::size_t count) {
  std::vector<ScanResult> results;
  for (; count > 0; --count) {
    const std::size_t points = held.front().scan.voxel_of_point.size();
    ScanResult& result = results.emplace_back(std::move(held.front().result));
    held.pop_front();
    result.labels.resize(points, kStaticLabel);
    if (records_scores) result.scores.resize(points, 0);
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
  state_->expect_scan();
  return state_->push(state_->observe(points, map_from_sensor, state_->pool));
}

ObservedScan Pipeline::observe(std::span<const Point> points, const Pose& map_from_sensor) {
  // The other half of the threads is busy with the scan before.
  if (!state_->observing_pool)
    state_->observing_pool.emplace(std::max(1U, state_->pool.size() / 2));
  return state_->observe(points, map_from_sensor, *state_->observing_pool);
}

std::vector<ScanResult> Pipeline::push(ObservedScan observed) {
  return state_->push(std::move(observed));
}

std::vector<ScanResult> Pipeline::finish() {
  state_->finished = true;
  return state_->release(state_->held.size());
}

void Pipeline::record_stages(std::vector<StageEvent>* events) { state_->events = events; }

void Pipeline::record_scores(bool record) { state_->records_scores = record; }

std::size_t Pipeline::map_blocks() const {
  return state_->memory ? state_->memory->map.block_count() : 0;
}

std::size_t Pipeline::State::memory_bytes() const {
  if (!memory) return 0;
  std::size_t bytes = scratch.memory_bytes() + previous_measured.memory_bytes();
  for (const HeldScan& scan : held) {
    bytes += scan.scan.memory_bytes() + scan.result.labels.capacity() * sizeof(std::uint32_t) +
             scan.result.scores.capacity() * sizeof(std::int32_t);
  }
  return bytes + memory->map.memory_bytes() + memory->window.memory_bytes() +
         memory->region.memory_bytes() + memory->carried.memory_bytes();
}

std::size_t Pipeline::memory_bytes() const { return state_->memory_bytes(); }

}  // namespace mosbench
