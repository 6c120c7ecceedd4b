#include "core/methods/lc_free_space/pipeline.hpp"

#include <cstddef>
#include <cstdint>
#include <stdexcept>

#include "core/base/method_row.hpp"
#include "core/base/stage_clock.hpp"
#include "core/voxel/voxelize.hpp"

namespace mosbench::lc_free_space {
namespace {

/// Returns the voxels of a block that share a face with one of its own in the mask.
BlockMask beside(const BlockMask& mask) {
  BlockMask result;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    const std::uint64_t word = mask.words[z];
    result.words[z] = beside_in_row(word) | word << 8 | word >> 8;
    if (z > 0) result.words[z] |= mask.words[z - 1];
    if (z + 1 < kBlockSide) result.words[z] |= mask.words[z + 1];
  }
  return result;
}

/// The masks of the six blocks around one; those that are absent are empty.
struct Sides {
  BlockMask left, right, front, back, below, above;
};

/// Returns the voxels of a block that share a face with one of the masks around it.
BlockMask beside(const Sides& sides) {
  BlockMask result;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    result.words[z] = (sides.left.words[z] & kLastColumn) >> 7 |
                      (sides.right.words[z] & kFirstColumn) << 7 | sides.front.words[z] >> 56 |
                      sides.back.words[z] << 56;
  }
  result.words.front() |= sides.below.words.back();
  result.words.back() |= sides.above.words.front();
  return result;
}

}  // namespace

std::vector<BlockMask> in_free_space(const VoxelSet& measured, const tsdf::TsdfMap& map) {
  std::vector<BlockMask> result(measured.block_count());
  for (std::size_t slot = 0; slot < result.size(); ++slot) {
    const tsdf::MapBlock* block = map.find(measured.blocks[slot]);
    if (block == nullptr) continue;
    result[slot] = measured.masks[slot] & without(block->observed, block->near_surface);
  }
  return result;
}

std::vector<BlockMask> grown(const VoxelSet& measured, std::span<const BlockMask> seeds) {
  std::vector<BlockMask> result(seeds.size());
  for (std::size_t slot = 0; slot < seeds.size(); ++slot) {
    const BlockIndex& at = measured.blocks[slot];
    const auto seeds_at = [&](int x, int y, int z) {
      const std::uint32_t other = measured.find({at.x + x, at.y + y, at.z + z});
      return other == kNoSlot ? BlockMask{} : seeds[other];
    };
    const Sides sides{.left = seeds_at(-1, 0, 0),
                      .right = seeds_at(1, 0, 0),
                      .front = seeds_at(0, -1, 0),
                      .back = seeds_at(0, 1, 0),
                      .below = seeds_at(0, 0, -1),
                      .above = seeds_at(0, 0, 1)};
    const BlockMask around = beside(seeds[slot]) | beside(sides);
    result[slot] = seeds[slot] | (around & measured.masks[slot]);
  }
  return result;
}

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

void check(const Config& config) {
  check_ranges(config);
  tsdf::check_common(config);
  if (config.free_above_m() >= config.truncation_m()) {
    throw std::invalid_argument(
        "free_above_voxels: not below truncation_voxels, which no distance exceeds, expected "
        "threshold < truncation");
  }
}

/// "lc-free-space": points in space that a volumetric map holds free.
MethodKind method_kind() {
  return {.name = "lc-free-space",
          .title = "LC Free Space (our reading)",
          .source =
              "Modayil, Kuipers: The Initial Development of Object Knowledge by a Learning Robot, "
              "Robotics and Autonomous Systems 56, 2008, as a row of Dynablox's table, "
              "arXiv:2304.10049; no code for it was published",
          .summary = "points in space that a volumetric map holds free, and those beside them",
          .defaults = settings_of(Config{}),
          .check = check_settings<Config>,
          .make = make_method<Pipeline, Config>,
          .score_name = "distance to surfaces, m"};
}

}  // namespace mosbench::lc_free_space
