#include "core/hmm_mos/pipeline.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/rigid.hpp"
#include "core/base/stage_clock.hpp"
#include "core/base/thread_pool.hpp"
#include "core/hmm_mos/convolution.hpp"
#include "core/hmm_mos/dilation.hpp"
#include "core/hmm_mos/dynamic_region.hpp"
#include "core/hmm_mos/label_projection.hpp"
#include "core/hmm_mos/local_window.hpp"
#include "core/hmm_mos/median.hpp"
#include "core/hmm_mos/threshold.hpp"
#include "core/hmm_mos/voxel_map.hpp"
#include "core/voxel/neighbourhood.hpp"
#include "core/voxel/raycast.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::hmm_mos {
namespace {

/// A scan that is ready to enter the map.
struct ObservedScan final : Observed {
  VoxelizedScan scan;
  VoxelList observed;  ///< by its rays
  std::vector<StageTime> stages;
};

/// What the method remembers between scans.
struct Memory {
  Memory(const Config& config, const VoxelGrid& grid)
      : map(config, grid),
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
  LabelledScan result;
};

}  // namespace

struct Pipeline::State {
  State(const Config& method_config, const RunContext& run)
      : config(method_config), context(run), pool(run.threads) {}

  std::unique_ptr<ObservedScan> observe(std::span<const Point> points, const Pose& map_from_sensor,
                                        ThreadPool& observing);
  std::vector<LabelledScan> push(ObservedScan& observed);
  void expect_scan() const;
  void enter_map(const ObservedScan& current, const StageRecord& record, std::uint32_t k);
  void detect(HeldScan& held_scan, std::uint32_t k);
  std::vector<LabelledScan> release(std::size_t count);
  std::size_t memory_bytes() const;

  Config config;
  RunContext context;
  ThreadPool pool;
  std::optional<ThreadPool> observing_pool;  ///< for scans observed during a push
  std::optional<VoxelGrid> grid;             ///< around the first scan
  RaycastScratch scratch;
  std::optional<Memory> memory;
  std::deque<HeldScan> held;  ///< the last delay + 1 scans, current one last
  VoxelSet previous_measured;
  std::size_t pushed = 0;
  bool finished = false;
};

/// Finds P'_M and P'_obs, which need no earlier scan.
std::unique_ptr<ObservedScan> Pipeline::State::observe(std::span<const Point> points,
                                                       const Pose& map_from_sensor,
                                                       ThreadPool& observing) {
  check_rigid(map_from_sensor);
  auto current = std::make_unique<ObservedScan>();
  const StageRecord record{current->stages, context.cpu_times};
  const VoxelGrid around =
      grid ? *grid : grid_around(map_from_sensor.translation(), config.voxel_size_m);
  current->scan = timed(record, "voxelize", [&] {
    return voxelize(points, map_from_sensor, around, config.min_range_m, config.max_range_m,
                    observing);
  });
  if (!grid) grid = around;  // written once: the previous scan may be pushed meanwhile
  current->observed = timed(record, "raycast", [&] {
    return raycast(current->scan.measured, current->scan.sensor_voxel, config.voxel_size_m,
                   config.max_range_m, scratch, observing);
  });
  return current;
}

/// Updates beliefs x and states S of observed voxels; voxels out of range or unobserved for w_g
/// leave.
void Pipeline::State::enter_map(const ObservedScan& current, const StageRecord& record,
                                std::uint32_t k) {
  const VoxelizedScan& scan = current.scan;
  if (!memory) memory.emplace(config, *grid);
  {
    const StageClock clock(record, "map_update");
    std::vector<const VoxelSet*> sources{&scan.measured};
    if (config.distance_field_scans == 2) sources.push_back(&previous_measured);
    memory->map.update(current.observed, sources, scan.sensor_m, k, pool);
  }
  const StageClock clock(record, "evict");
  memory->map.evict(k);
}

/// Finds what moves in a scan with the map as it is after scan k.
void Pipeline::State::detect(HeldScan& held_scan, std::uint32_t k) {
  const VoxelizedScan& scan = held_scan.scan;
  LabelledScan& result = held_scan.result;
  const StageRecord record{result.stages, context.cpu_times};
  LocalWindow& window = memory->window;
  DynamicRegion& region = memory->region;
  result.judged = true;
  result.threshold.reset();
  if (scan.occupied_count == 0) {
    window.join({});
    return;
  }
  const int width = config.kernel_width_voxels;
  VoteField votes = timed(record, "convolution", [&] {
    const VoxelSet changed = scan.occupied_among(
        memory->map.changed_since(k - static_cast<std::uint32_t>(config.delay_scans)));
    const std::vector<std::uint32_t> slots = slots_within(scan, changed, radius_of(width));
    const VoxelSet known = memory->map.known_at(k, blocks_of(scan, slots), pool);
    return convolve(scan, slots, changed, known, width, pool);
  });
  votes = timed(record, "median", [&] { return median_filter(scan, votes, pool); });
  const SumField sums = timed(record, "window", [&] {
    window.join(std::move(votes));
    return window.sums(scan);
  });
  VoxelSet& dynamic = memory->carried;
  {
    const StageClock clock(record, "otsu");
    result.threshold = threshold_of(scan, sums);
    dynamic = above_threshold(scan, sums, result.threshold, dynamic, config.min_otsu_score);
    dynamic = dilate_occupied(scan, dynamic, pool);
  }
  VoxelSet from_region;
  if (config.variant == Variant::kPaper2024) {
    const StageClock clock(record, "dynamic_region");
    const std::vector<std::uint32_t> slots = slots_around(scan, region.blocks_with(dynamic));
    const VoxelSet known = memory->map.known_at(k, blocks_of(scan, slots), pool);
    const VoxelSet beside = beside_unknown(scan, slots, known, width, pool);
    from_region = region.back_end(scan, beside, width, pool);
    region.update({scan, dynamic, from_region, beside, result.threshold}, k);
  }
  const StageClock clock(record, "labels");
  const VoxelSet moving = shows_motion(result.threshold, config.min_otsu_score)
                              ? united(dynamic, from_region)
                              : VoxelSet{};
  result.labels = project_labels(scan, moving);
  if (context.scores) result.scores = project_scores(scan, sums);
}

void Pipeline::State::expect_scan() const {
  if (context.scan_count && pushed >= *context.scan_count) {
    throw std::logic_error("pushed more scans than scan_count announced");
  }
  if (finished) throw std::logic_error("pushed a scan after finish");
}

std::vector<LabelledScan> Pipeline::State::push(ObservedScan& observed) {
  expect_scan();
  if (!grid) throw std::logic_error("pushed a scan that this pipeline did not observe");
  const auto k = static_cast<std::uint32_t>(pushed);
  LabelledScan taken_in;
  taken_in.scan_index = pushed;
  taken_in.nonfinite_points = observed.scan.nonfinite_points;
  taken_in.stages = std::move(observed.stages);
  enter_map(observed, {taken_in.stages, context.cpu_times}, k);
  previous_measured = observed.scan.measured;
  held.push_back({std::move(observed.scan), std::move(taken_in)});
  ++pushed;

  const auto n = static_cast<std::size_t>(config.delay_scans);
  if (k <= static_cast<std::uint32_t>(config.local_window_scans)) {
    memory->window.join({});
  } else if (n == 0) {
    detect(held.back(), k);
  } else if (k > n) {
    detect(held.front(), k);
    // The authors' program labels the end of a delayed sequence online, and leaves scan N - n
    // static.
    if (context.scan_count && k + n > *context.scan_count) detect(held.back(), k);
  }
  return held.size() > n ? release(1) : std::vector<LabelledScan>{};
}

/// Returns the oldest held scans; points of scans that were not judged are static.
std::vector<LabelledScan> Pipeline::State::release(std::size_t count) {
  std::vector<LabelledScan> results;
  for (; count > 0; --count) {
    const std::size_t points = held.front().scan.voxel_of_point.size();
    LabelledScan& result = results.emplace_back(std::move(held.front().result));
    held.pop_front();
    result.labels.resize(points, kStaticLabel);
    if (context.scores) result.scores.resize(points, 0);
  }
  return results;
}

Pipeline::Pipeline(const Config& config, const RunContext& context) {
  check(config);
  if (context.threads == 0) throw std::invalid_argument("threads: 0, expected at least 1");
  state_ = std::make_unique<State>(config, context);
}

Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;

std::vector<LabelledScan> Pipeline::push(std::span<const Point> points,
                                         const Pose& map_from_sensor) {
  state_->expect_scan();
  return state_->push(*state_->observe(points, map_from_sensor, state_->pool));
}

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
  return state_->push(*scan);
}

std::vector<LabelledScan> Pipeline::finish() {
  state_->finished = true;
  return state_->release(state_->held.size());
}

std::size_t Pipeline::State::memory_bytes() const {
  if (!memory) return 0;
  std::size_t bytes = scratch.memory_bytes() + previous_measured.memory_bytes();
  for (const HeldScan& scan : held) {
    bytes += scan.scan.memory_bytes() + scan.result.labels.capacity() * sizeof(std::uint32_t) +
             scan.result.scores.capacity() * sizeof(float);
  }
  return bytes + memory->map.memory_bytes() + memory->window.memory_bytes() +
         memory->region.memory_bytes() + memory->carried.memory_bytes();
}

MemoryUse Pipeline::memory() const {
  return {state_->memory_bytes(), state_->memory ? state_->memory->map.block_count() : 0};
}

std::vector<std::string> Pipeline::remarks() const {
  return remarks_on_delay(state_->config, state_->context);
}

std::vector<std::string> remarks_on_delay(const Config& config, const RunContext& context) {
  const auto delay = static_cast<std::size_t>(config.delay_scans);
  if (delay == 0 || !context.scan_count) return {};
  const std::string scans = std::to_string(delay) + " scans";
  if (*context.scan_count <= delay) {
    return {"shorter than the delay of " + scans + ": every scan is labelled static"};
  }
  return {"the last " + scans + " have no " + std::to_string(delay) +
          " later ones: the first of them is labelled static and the others are judged online, as "
          "the authors' program does"};
}

}  // namespace mosbench::hmm_mos
