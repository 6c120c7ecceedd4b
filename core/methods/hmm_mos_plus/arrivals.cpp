#include "core/methods/hmm_mos_plus/arrivals.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// The neighbours of a seed that should be known: a cube of 5^3 voxels.
constexpr int kCubeVoxels = 125;
/// A surface that left a voxel so short a time ago may be beside it by noise alone, and one that
/// arrived may be what left beside it.
constexpr std::uint32_t kTurnedTicks = 5;

/// The evidence that makes a voxel a seed.
enum class Evidence { kArrival, kDeparture };

std::uint32_t ticks_of(double age_s) {
  return static_cast<std::uint32_t>(std::lround(age_s / TickClock::kSeconds));
}

/// Returns, of the blocks around raw[slots], the settled voxels that did not arrive of late; for
/// arrivals also those that were just left, for departures those that just arrived.
VoxelSet firm_voxels(const VoxelizedScan& scan, const ScanMasks& raw,
                     const std::vector<std::uint32_t>& slots, const RememberedMap& map,
                     std::uint32_t seed_age_ticks, Evidence evidence) {
  VoxelSet firm;
  for (const std::uint32_t slot : slots) {
    const std::uint32_t near = blocks_within(raw[slot], 1);
    for_each_neighbour(scan.measured.blocks[slot], [&](std::size_t position, const BlockIndex& at) {
      if (near >> position & 1) firm.insert(at);
    });
  }
  for (std::size_t i = 0; i < firm.block_count(); ++i) {
    const auto past = map.past_at(firm.blocks[i]);
    if (!past) continue;
    const BlockMask settled = past->history.settled() & past->known.occupied;
    const BlockMask of_late = past->history.sure_within(settled, seed_age_ticks, past->tick);
    firm.masks[i] = without(settled, of_late);
    const BlockMask turned =
        evidence == Evidence::kArrival
            ? past->history.left_within(past->known.free, kTurnedTicks, past->tick)
            : past->history.arrived_within(past->known.occupied, kTurnedTicks, past->tick);
    firm.masks[i] = firm.masks[i] | turned;
  }
  return firm;
}

/// Takes away what lies beside firm voxels.
void keep_apart(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                Evidence evidence, ThreadPool& pool, ScanMasks& raw) {
  const std::vector<std::uint32_t> slots = slots_with_any(raw);
  const VoxelSet firm = firm_voxels(scan, raw, slots, map, ticks_of(config.seed_age_s), evidence);
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows rows;
    for (std::size_t i = begin; i < end; ++i) {
      gather_around(firm, scan.measured.blocks[slots[i]], 1, rows);
      raw[slots[i]] = without(raw[slots[i]], dilate(rows));
    }
  });
}

/// Adds to seeds[i] those of raw[i] that lie apart from firm voxels and in known space.
void add_seeds(const VoxelizedScan& scan, ScanMasks raw, const RememberedMap& map,
               const Config& config, Evidence evidence, ThreadPool& pool, ScanMasks& seeds) {
  keep_apart(scan, map, config, evidence, pool, raw);
  const std::vector<std::uint32_t> slots = slots_with_any(raw);
  const VoxelSet known = map.map.known_at(map.k, blocks_of(scan, slots), pool);
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows rows, closed;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t slot = slots[i];
      const int gap = config.max_gap_voxels;
      gather_around(known, scan.measured.blocks[slot], kKnownRadius + gap, rows);
      close_columns(rows, gap, closed);
      for_each_cell(raw[slot], [&](std::uint32_t cell) {
        const int unknown = kCubeVoxels - count_around(closed, cell);
        if (unknown <= config.max_unknown_voxels) seeds[slot].set(cell);
      });
    }
  });
}

/// Returns, of a scan's voxels in one block, those straight above or below which it saw through.
BlockMask open_among(const BlockMask& voxels, const VoxelizedScan& scan, const RememberedMap& map,
                     const BlockIndex& at) {
  const auto seen_through = [&](int dz) {
    const BlockIndex index{at.x, at.y, at.z + dz};
    const auto past = map.past_at(index);
    const BlockMask* occupied = scan.occupied_in(index);
    if (!past) return BlockMask{};
    return occupied == nullptr ? past->observed : without(past->observed, *occupied);
  };
  const BlockMask below = seen_through(-1), own = seen_through(0), above = seen_through(1);
  BlockMask open;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    open.words[z] = voxels.words[z] & ((z > 0 ? own.words[z - 1] : below.words.back()) |
                                       (z + 1 < kBlockSide ? own.words[z + 1] : above.words[0]));
  }
  return open;
}

}  // namespace

ArrivalClasses classify(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                        ThreadPool& pool) {
  const std::size_t blocks = scan.measured.block_count();
  const ScanMasks none(blocks);
  ArrivalClasses classes{none, none, none, none, none, none, none};
  const std::uint32_t seed_age_ticks = ticks_of(config.seed_age_s);
  const std::uint32_t fresh_age_ticks = ticks_of(config.fresh_age_s);
  const std::uint32_t object_age_ticks = ticks_of(config.object_age_s);
  for (std::size_t i = 0; i < blocks; ++i) {
    if (!scan.occupied[i].any()) continue;
    const auto past = map.past_at(scan.measured.blocks[i]);
    if (!past) continue;  // at the range limit not every occupied voxel is observed
    const auto& history = past->history;
    const BlockMask occupied = scan.occupied[i] & past->known.occupied;
    classes.arrived[i] = history.sure_within(occupied, seed_age_ticks, past->tick);
    classes.fresh[i] = history.sure_within(classes.arrived[i], fresh_age_ticks, past->tick);
    const bool may_depart = config.map.delay_scans > 0;
    const BlockMask& candidates = may_depart ? occupied : classes.arrived[i];
    if (candidates.any()) {
      classes.open[i] = open_among(candidates, scan, map, scan.measured.blocks[i]);
    }
    classes.aged[i] = history.aged() & occupied;
    const BlockMask came = history.arrived_within(classes.aged[i], object_age_ticks, past->tick);
    classes.settled[i] = without(history.settled() & occupied, came);
    classes.standing[i] =
        without(classes.aged[i], history.arrived_within(came, object_age_ticks / 2, past->tick));
  }
  add_seeds(scan, classes.arrived, map, config, Evidence::kArrival, pool, classes.seeds);
  return classes;
}

void add_departures(const VoxelizedScan& scan, const RememberedMap& map, const Config& config,
                    ThreadPool& pool, ArrivalClasses& classes) {
  ScanMasks departed(scan.measured.block_count());
  for (std::size_t i = 0; i < departed.size(); ++i) {
    const auto past = map.past_at(scan.measured.blocks[i]);
    if (past) departed[i] = scan.occupied[i] & past->known.free;
    classes.settled[i] = without(classes.settled[i], departed[i]);
    classes.aged[i] = without(classes.aged[i], departed[i]);
    classes.standing[i] = without(classes.standing[i], departed[i]);
    classes.fresh[i] = classes.fresh[i] | departed[i];
    classes.arrived[i] = classes.arrived[i] | departed[i];
  }
  add_seeds(scan, std::move(departed), map, config, Evidence::kDeparture, pool, classes.seeds);
}

}  // namespace mosbench::hmm_mos_plus
