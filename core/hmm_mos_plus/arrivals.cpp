#include "core/hmm_mos_plus/arrivals.hpp"

#include <cmath>
#include <vector>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// The neighbours of a seed that should be known: a cube of 5^3 voxels.
constexpr int kKnownRadius = 2, kCubeVoxels = 125;

std::uint32_t ticks_of(double age_s) {
  return static_cast<std::uint32_t>(std::lround(age_s / hmm_mos::TickClock::kSeconds));
}

/// Returns the voxels of the map in these blocks that are settled and did not arrive of late.
VoxelSet firm_voxels(hmm_mos::VoxelMap& map, const std::vector<BlockIndex>& blocks, std::uint32_t k,
                     std::uint32_t seed_age_ticks) {
  VoxelSet firm;
  for (const BlockIndex& block : blocks) {
    const auto past = map.past_at(k, block);
    const BlockMask settled = past->history.settled() & past->known.occupied;
    if (!settled.any()) continue;
    const BlockMask mask = without(settled, past->history.sure_within(seed_age_ticks, past->tick));
    if (mask.any()) firm.masks[firm.insert(block)] = mask;
  }
  return firm;
}

/// Adds to seeds[i] those of raw[i] that lie apart from firm voxels and in known space.
void add_seeds(const VoxelizedScan& scan, const ScanMasks& raw, hmm_mos::VoxelMap& map,
               std::uint32_t k, const Config& config, ThreadPool& pool, ScanMasks& seeds) {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < raw.size(); ++slot) {
    if (raw[slot].any()) slots.push_back(slot);
  }
  const VoxelSet known = map.known_at(k, blocks_of(scan, slots), pool);
  const VoxelSet firm = firm_voxels(map, known.blocks, k, ticks_of(config.seed_age_s));
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows rows;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t slot = slots[i];
      gather_around(firm, scan.measured.blocks[slot], 1, rows);
      const BlockMask apart = without(raw[slot], dilate(rows));
      if (!apart.any()) continue;
      gather_around(known, scan.measured.blocks[slot], kKnownRadius, rows);
      for_each_cell(apart, [&](std::uint32_t cell) {
        const int unknown = kCubeVoxels - count_around(rows, cell);
        if (unknown <= config.max_unknown_voxels) seeds[slot].set(cell);
      });
    }
  });
}

}  // namespace

ArrivalClasses classify(const VoxelizedScan& scan, hmm_mos::VoxelMap& map, std::uint32_t k,
                        const Config& config, ThreadPool& pool) {
  const std::size_t blocks = scan.measured.block_count();
  ArrivalClasses classes{ScanMasks(blocks), ScanMasks(blocks), ScanMasks(blocks),
                         ScanMasks(blocks)};
  const std::uint32_t seed_age_ticks = ticks_of(config.seed_age_s);
  const std::uint32_t fresh_age_ticks = ticks_of(config.fresh_age_s);
  const std::uint32_t object_age_ticks = ticks_of(config.object_age_s);
  ScanMasks young(blocks);
  for (std::size_t i = 0; i < blocks; ++i) {
    if (!scan.occupied[i].any()) continue;
    const auto past = map.past_at(k, scan.measured.blocks[i]);
    if (!past) continue;  // at the range limit not every occupied voxel is observed
    const auto& history = past->history;
    const BlockMask occupied = scan.occupied[i] & past->known.occupied;
    young[i] = history.sure_within(seed_age_ticks, past->tick) & occupied;
    classes.fresh[i] = history.sure_within(fresh_age_ticks, past->tick) & young[i];
    classes.aged[i] = history.aged() & occupied;
    const BlockMask settled = history.settled() & occupied;
    if (!settled.any()) continue;
    classes.settled[i] = without(settled, history.arrived_within(object_age_ticks, past->tick));
  }
  add_seeds(scan, young, map, k, config, pool, classes.seeds);
  return classes;
}

void add_departures(const VoxelizedScan& scan, hmm_mos::VoxelMap& map, std::uint32_t k,
                    const Config& config, ThreadPool& pool, ArrivalClasses& classes) {
  ScanMasks departed(scan.measured.block_count());
  for (std::size_t i = 0; i < departed.size(); ++i) {
    const auto past = map.past_at(k, scan.measured.blocks[i]);
    if (past) departed[i] = scan.occupied[i] & past->known.free;
    classes.settled[i] = without(classes.settled[i], departed[i]);
    classes.aged[i] = without(classes.aged[i], departed[i]);
    classes.fresh[i] = classes.fresh[i] | departed[i];
  }
  add_seeds(scan, departed, map, k, config, pool, classes.seeds);
}

}  // namespace mosbench::hmm_mos_plus
