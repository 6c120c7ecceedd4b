#include "core/methods/hmm_mos/detector.hpp"

#include <utility>
#include <vector>

#include "core/methods/hmm_mos/convolution.hpp"
#include "core/methods/hmm_mos/dilation.hpp"
#include "core/methods/hmm_mos/median.hpp"
#include "core/methods/hmm_mos/threshold.hpp"
#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos {

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

}  // namespace mosbench::hmm_mos
