#include "core/methods/hmm_mos/pipeline.hpp"

#include <mosbench/scan.hpp>
#include <stdexcept>
#include <utility>

#include "core/base/method_row.hpp"
#include "core/methods/hmm_mos/hmm.hpp"
#include "core/methods/hmm_mos/median.hpp"
#include "core/methods/hmm_mos/otsu.hpp"
#include "core/tracks/judged_by_tracks.hpp"
#include "core/voxel/distance_field.hpp"
#include "core/voxel/neighbourhood.hpp"
#include "core/voxel/raycast.hpp"

namespace mosbench::hmm_mos {
namespace {

constexpr std::string_view kSource =
    "Bhandari, James, Phillips, McAree: Moving Object Segmentation in Point Cloud Data using "
    "Hidden Markov Models, 2024, arXiv:2410.18638";
constexpr std::string_view kScoreName = "dynamic score";
constexpr std::string_view kThresholdName = "Otsu threshold";

std::unique_ptr<Method> make_slow(const Settings& settings, const RunContext& context) {
  return tracks::make_by<Config>(settings, context, make_reference);
}

}  // namespace

std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan, const VoxelSet& moving) {
  if (moving.block_count() == 0) {
    return std::vector<std::uint32_t>(scan.voxel_of_point.size(), kStaticLabel);
  }
  std::vector<BlockMask> masks(scan.measured.block_count());
  for (std::size_t i = 0; i < moving.block_count(); ++i) {
    masks[scan.measured.find(moving.blocks[i])] = moving.masks[i];
  }
  return mosbench::project_labels(scan, masks);
}

std::vector<float> project_scores(const VoxelizedScan& scan, const SumField& sums) {
  std::vector<const SumField::Block*> values;
  for (const BlockIndex& block : scan.measured.blocks) values.push_back(sums.find(block));
  return mosbench::project_scores(scan, [&](std::uint32_t slot, std::uint32_t cell) {
    return values[slot] == nullptr ? 0.0F : static_cast<float>((*values[slot])[cell]);
  });
}

DueScans due_at(std::uint32_t k, const Config& config, std::optional<std::size_t> scan_count) {
  const auto n = static_cast<std::size_t>(config.delay_scans);
  if (k <= static_cast<std::uint32_t>(config.local_window_scans)) return {.none_yet = true};
  if (n == 0) return {.newest = true};
  if (k <= n) return {};
  return {.oldest = true, .newest = scan_count && k + n > *scan_count};
}

Detector::Detector(const Config& config, const VoxelGrid& grid)
    : config_(config),
      window_(config.local_window_scans),
      region_(grid, config.max_range_m, config.dynamic_window_scans, config.min_otsu_score) {}

Detection Detector::detect(const VoxelizedScan& scan, VoxelMap& map, std::uint32_t k,
                           ThreadPool& pool, const StageRecord& record) {
  Detection found;
  if (scan.occupied_count == 0) {
    window_.join({});
    return found;
  }
  const int width = config_.kernel_width_voxels;
  VoteField votes = timed(record, "convolution", [&] {
    const VoxelSet changed =
        scan.occupied_among(map.changed_since(k - static_cast<std::uint32_t>(config_.delay_scans)));
    const std::vector<std::uint32_t> slots = slots_within(scan, changed, radius_of(width));
    const VoxelSet known = map.known_at(k, blocks_of(scan, slots), pool);
    return convolve(scan, slots, changed, known, width, pool);
  });
  votes = timed(record, "median", [&] { return median_filter(scan, votes, pool); });
  found.sums = timed(record, "window", [&] {
    window_.join(std::move(votes));
    return window_.sums(scan);
  });
  VoxelSet& dynamic = carried_;
  {
    const StageClock clock(record, "otsu");
    found.threshold = threshold_of(scan, found.sums);
    dynamic = above_threshold(scan, found.sums, found.threshold, dynamic, config_.min_otsu_score);
    dynamic = dilate_occupied(scan, dynamic, pool);
  }
  VoxelSet from_region;
  if (config_.variant == Variant::kPaper2024) {
    const StageClock clock(record, "dynamic_region");
    const std::vector<std::uint32_t> slots = slots_around(scan, region_.blocks_with(dynamic));
    const VoxelSet known = map.known_at(k, blocks_of(scan, slots), pool);
    const VoxelSet beside = beside_unknown(scan, slots, known, width, pool);
    from_region = region_.back_end(scan, beside, width, pool);
    region_.update({scan, dynamic, from_region, beside, found.threshold}, k);
  }
  if (shows_motion(found.threshold, config_.min_otsu_score)) {
    found.moving = united(dynamic, from_region);
  }
  return found;
}

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : MappedMethod(checked(config), context), config_(config) {}

std::vector<LabelledScan> Pipeline::entered(ObservedScan& current, LabelledScan begun) {
  if (!detector_) detector_.emplace(config_, grid());
  held_.push_back({std::move(current.scan), std::move(begun)});

  const DueScans due = due_at(k(), config_, context().scan_count);
  if (due.none_yet) detector_->skip();
  if (due.oldest) judge(held_.front());
  if (due.newest) judge(held_.back());
  const auto n = static_cast<std::size_t>(config_.delay_scans);
  return held_.size() > n ? release(1) : std::vector<LabelledScan>{};
}

void Pipeline::judge(HeldScan& held) {
  LabelledScan& result = held.result;
  const StageRecord record{result.stages, context().cpu_times};
  const Detection found = detector_->detect(held.scan, map(), k(), pool(), record);
  result.judged = true;
  result.threshold = found.threshold;
  const StageClock clock(record, "labels");
  result.labels = project_labels(held.scan, found.moving);
  if (context().scores) result.scores = project_scores(held.scan, found.sums);
}

/// Returns the oldest held scans; points of scans that were not judged are static.
std::vector<LabelledScan> Pipeline::release(std::size_t count) {
  std::vector<LabelledScan> results;
  for (; count > 0; --count) {
    const std::size_t points = held_.front().scan.voxel_of_point.size();
    LabelledScan& result = results.emplace_back(std::move(held_.front().result));
    held_.pop_front();
    result.labels.resize(points, kStaticLabel);
    if (context().scores) result.scores.resize(points, 0);
  }
  return results;
}

std::size_t Pipeline::held_bytes() const {
  std::size_t bytes = detector_ ? detector_->memory_bytes() : 0;
  for (const HeldScan& held : held_) {
    bytes += held.scan.memory_bytes() + held.result.labels.capacity() * sizeof(std::uint32_t) +
             held.result.scores.capacity() * sizeof(float);
  }
  return bytes;
}

std::vector<std::string> Pipeline::remarks() const { return remarks_on_delay(config_, context()); }

std::vector<std::string> remarks_on_delay(const Config& config, const RunContext& context) {
  constexpr std::size_t kMostDelay_scans = 15;
  const auto delay = static_cast<std::size_t>(config.delay_scans);
  const std::string scans = std::to_string(delay) + " scans";
  std::vector<std::string> remarks;
  if (delay > kMostDelay_scans) {
    remarks.push_back("a delay of " + scans + " costs precision: after more than " +
                      std::to_string(kMostDelay_scans) +
                      " scans, surfaces seen from elsewhere look as if they had left; --set "
                      "delay=all judges whole tracks instead");
  }
  if (delay == 0 || !context.scan_count) return remarks;
  if (*context.scan_count <= delay) {
    remarks.push_back("shorter than the delay of " + scans + ": every scan is labelled static");
  } else {
    remarks.push_back("the last " + scans + " have no " + std::to_string(delay) +
                      " later ones: the first of them is labelled static and the others are judged "
                      "online, as the authors' program does");
  }
  return remarks;
}

void check(const Config& config) {
  check_ranges(config);
  if (config.kernel_width_voxels % 2 == 0) {
    throw std::invalid_argument(
        "kernel_width_voxels: " + std::to_string(config.kernel_width_voxels) +
        " is even, expected an odd width");
  }
  check_range_limits(config.min_range_m, config.max_range_m);
  check_voxels("max_range_m", config.max_range_m / config.voxel_size_m, "voxel_size_m",
               kMaxRangeVoxels);
  // The distance field reaches as far as a likelihood can change a state.
  const double reach_per_sigma =
      likelihood_reach_sigmas(config.transition_epsilon, config.min_state_probability);
  check_voxels("occupancy_sigma_m", config.sigma_m() / config.voxel_size_m, "voxel_size_m",
               kMaxDistanceRadius / reach_per_sigma);
  tracks::check_window(config.track_window_s, config.delay_scans);
  if (config.variant == Variant::kRelease2025 &&
      (config.delay_scans != 0 || config.track_window_s > 0)) {
    const bool delays = config.delay_scans != 0;
    throw std::invalid_argument(
        (delays ? "delay_scans: " + std::to_string(config.delay_scans) : "track_window_s: is set") +
        " in release-2025, which has no delay, expected 0");
  }
}

/// "hmm-mos": the pipeline behind the interface of all methods.
MethodKind method_kind() {
  return {.name = "hmm-mos",
          .title = "HMM-MOS",
          .source = kSource,
          .summary =
              "a three-state hidden Markov model per voxel, changes convolved over space and time",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = tracks::make_method<Pipeline, Config>,
          .score_name = kScoreName,
          .threshold_name = kThresholdName,
          .takes_origins = true,
          .is_named_by_variant = true};
}

/// "hmm-mos-reference": the same labels by the obvious code of reference.hpp, hundreds of times
/// slower.
MethodKind reference_kind() {
  return {
      .name = "hmm-mos-reference",
      .title = "HMM-MOS (reference)",
      .source = kSource,
      .summary = "the same labels, step by step as in the paper; up to thousands of times slower",
      .defaults = settings_of(Config{}),
      .check = check_settings<Config>,
      .make = make_slow,
      .is_twin = true,
      .score_name = kScoreName,
      .threshold_name = kThresholdName,
      .takes_origins = true};
}

}  // namespace mosbench::hmm_mos
