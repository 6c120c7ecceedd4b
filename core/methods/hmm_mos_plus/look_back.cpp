#include "core/methods/hmm_mos_plus/look_back.hpp"

#include <utility>
#include <vector>

#include "core/methods/hmm_mos_plus/objects.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// After so many scans most voxels that an object left are free.
constexpr std::size_t kScans = 2;

}  // namespace

LookBack::LookBack(const Config& config) : config_(config), tracks_(config) {}

void LookBack::look(const RememberedMap& map, ThreadPool& pool) {
  if (past_.size() < kScans) return;
  Past& then = past_.front();
  add_departures(then.scan, map, config_, pool, then.classes);
  LowVoxels low(then.scan, *then.ground);
  tracks_.follow(then.scan, find_components(then.scan, then.classes, *then.ground, low, config_),
                 then.tick);
  past_.pop_front();
}

void LookBack::add_seeds(const VoxelizedScan& scan, LowVoxels& low, ArrivalClasses& classes) const {
  Tick since = past_.back().tick;
  since.periods = 0;
  for (const Past& later : past_) since.periods += later.tick.periods;
  tracks_.add_seeds(scan, low, since, classes);
}

void LookBack::enter(const VoxelizedScan& scan, const ArrivalClasses& classes,
                     std::shared_ptr<const Ground> ground, const Tick& tick,
                     const RememberedMap& map, ThreadPool& pool) {
  look(map, pool);
  ScanMasks may_move(scan.occupied.size());
  for (std::uint32_t slot = 0; slot < may_move.size(); ++slot) {
    may_move[slot] = without(scan.occupied[slot], classes.settled[slot]) | classes.seeds[slot];
  }
  const std::vector<std::uint32_t> slots = slots_with_any(may_move);
  const auto of_slots = [&](const ScanMasks& masks) {
    ScanMasks kept(slots.size());
    for (std::size_t i = 0; i < slots.size(); ++i) kept[i] = masks[slots[i]];
    return kept;
  };
  VoxelizedScan part;
  part.measured.reserve(slots.size());
  for (const std::uint32_t slot : slots) part.measured.insert(scan.measured.blocks[slot]);
  part.occupied = of_slots(may_move);
  past_.push_back({std::move(part),
                   {.seeds = of_slots(classes.seeds),
                    .fresh = of_slots(classes.fresh),
                    .settled = ScanMasks(slots.size()),
                    .aged = of_slots(classes.aged),
                    .standing = of_slots(classes.standing)},
                   std::move(ground),
                   tick});
}

std::size_t LookBack::memory_bytes() const {
  std::size_t bytes = tracks_.memory_bytes();
  for (const Past& past : past_) {
    bytes += past.scan.memory_bytes() + past.classes.memory_bytes() + past.ground->memory_bytes();
  }
  return bytes;
}

}  // namespace mosbench::hmm_mos_plus
