#include "core/lc_free_space/pipeline.hpp"

#include "core/base/stage_clock.hpp"
#include "core/lc_free_space/free_space.hpp"

namespace mosbench::lc_free_space {
namespace {

constexpr std::size_t kPointsAtATime = 4096;

}  // namespace

Pipeline::Pipeline(const Config& config, const RunContext& context)
    : TsdfMethod(checked(config), context, {.nearest_m = config.min_range_m}),
      config_(config),
      map_(config.least_free_m()) {}

void Pipeline::label(const VoxelizedScan& scan, LabelledScan& result) {
  std::vector<BlockMask> moving = in_free_space(scan.measured, map_);
  if (config_.level == Level::kCluster) {
    moving = grown(scan.measured, moving);
  } else {
    result.threshold = config_.free_above_m();
  }
  pool().for_ranges(
      result.labels.size(), kPointsAtATime, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t voxel = scan.voxel_of_point[i];
          if (voxel != kNoVoxel && moving[voxel / kBlockVoxels].test(voxel % kBlockVoxels)) {
            result.labels[i] = kMovingLabel;
          }
        }
      });
}

void Pipeline::score(const VoxelizedScan& scan, LabelledScan& result) {
  std::vector<const tsdf::MapBlock*> blocks;
  for (const BlockIndex& index : scan.measured.blocks) blocks.push_back(map_.find(index));
  result.scores.assign(result.labels.size(), 0);
  for (std::size_t i = 0; i < result.scores.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    result.scores[i] = map_.distance_m(blocks[voxel / kBlockVoxels], voxel % kBlockVoxels);
  }
}

void Pipeline::take(const tsdf::ObservedScan& observed, LabelledScan& result) {
  const StageRecord record{result.stages, context().cpu_times};
  timed(record, "free_space", [&] {
    label(observed.scan, result);
    if (context().scores) score(observed.scan, result);
  });
  timed(record, "integrate",
        [&] { integrate_scan(map_, map_.touch(observed.wide_blocks).slots, observed); });
  timed(record, "evict", [&] { map_.keep_near(observed.scan.sensor_m, grid(), config_); });
}

MemoryUse Pipeline::map_memory() const { return {map_.memory_bytes(), map_.blocks.size()}; }

}  // namespace mosbench::lc_free_space
