#include "core/methods/lc_free_space/pipeline.hpp"

#include "core/base/stage_clock.hpp"
#include "core/methods/lc_free_space/free_space.hpp"
#include "core/voxel/point_labels.hpp"

namespace mosbench::lc_free_space {

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
  result.labels = project_labels(scan, moving);
}

void Pipeline::score(const VoxelizedScan& scan, LabelledScan& result) {
  std::vector<const tsdf::MapBlock*> blocks;
  for (const BlockIndex& index : scan.measured.blocks) blocks.push_back(map_.find(index));
  result.scores = project_scores(scan, [&](std::uint32_t slot, std::uint32_t cell) {
    return map_.distance_m(blocks[slot], cell);
  });
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
