#include "core/methods/hmm_mos_plus/objects.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

namespace mosbench::hmm_mos_plus {
namespace {

constexpr std::size_t kAnySteps = std::numeric_limits<std::size_t>::max();

/// A scan's blocks with those around them, looked up when they are first asked for.
class Surroundings {
 public:
  using Slots = std::array<std::uint32_t, 27>;

  explicit Surroundings(const VoxelizedScan& scan)
      : scan_(scan), found_of_(scan.measured.block_count(), kNoSlot) {}

  const Slots& of(std::uint32_t slot) {
    if (found_of_[slot] == kNoSlot) {
      found_of_[slot] = static_cast<std::uint32_t>(found_.size());
      Slots& slots = found_.emplace_back();
      for_each_neighbour(scan_.measured.blocks[slot],
                         [&](std::size_t position, const BlockIndex& block) {
                           slots[position] = scan_.measured.find(block);
                         });
    }
    return found_[found_of_[slot]];
  }

  /// Calls visit(slot, cell) for the voxels within one of a voxel along x and y and from dz to
  /// last_dz along z, in blocks of the scan.
  template <typename Visit>
  void for_around(std::uint32_t voxel, int dz, int last_dz, Visit&& visit) {
    const Slots slots = of(voxel / kBlockVoxels);
    const auto cell = static_cast<int>(voxel % kBlockVoxels);
    const int x = cell & 7, y = cell >> 3 & 7, z = cell >> 6;
    for (int w = z + dz; w <= z + last_dz; ++w) {
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) {
          const int block = ((w >> 3) + 1) * 9 + ((v >> 3) + 1) * 3 + (u >> 3) + 1;
          const std::uint32_t slot = slots[static_cast<std::size_t>(block)];
          if (slot == kNoSlot) continue;
          visit(slot, static_cast<std::uint32_t>((w & 7) << 6 | (v & 7) << 3 | (u & 7)));
        }
      }
    }
  }

 private:
  const VoxelizedScan& scan_;
  std::vector<std::uint32_t> found_of_;
  std::vector<Slots> found_;
};

/// Moves voxels out of remaining_in(slot), a mask per block: those of `first`, and what is
/// connected with them over at most `steps` steps from voxel to voxel.
template <typename RemainingIn>
std::vector<std::uint32_t> take_connected(std::span<const std::uint32_t> first, std::size_t steps,
                                          RemainingIn&& remaining_in, Surroundings& surroundings) {
  std::vector<std::uint32_t> taken;
  const auto take = [&](std::uint32_t slot, std::uint32_t cell) {
    BlockMask& remaining = remaining_in(slot);
    if (!remaining.test(cell)) return;
    remaining.words[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63));
    taken.push_back(slot * kBlockVoxels + cell);
  };
  for (const std::uint32_t voxel : first) take(voxel / kBlockVoxels, voxel % kBlockVoxels);
  for (std::size_t next = 0; next < taken.size() && steps > 0; --steps) {
    for (const std::size_t layer = taken.size(); next < layer; ++next) {
      surroundings.for_around(taken[next], -1, 1, take);
    }
  }
  return taken;
}

bool has_size_of_object(const Box& box, double max_extent_m, const Config& config) {
  const double size_m = config.map.voxel_size_m;
  const Voxel& low = box.low;
  const Voxel& high = box.high;
  return std::max(high.x - low.x, high.y - low.y) * size_m <= max_extent_m &&
         (high.z - low.z) * size_m <= config.max_height_m;
}

/// Whether a component is more than a strip of ground.
bool rises_from_ground(const VoxelizedScan& scan, const std::vector<std::uint32_t>& voxels,
                       const Box& box, const Ground& ground, const Config& config) {
  const int radius = static_cast<int>(config.rise_radius_m / config.map.voxel_size_m);
  const std::vector<std::int32_t> lowest = ground.lowest_within(radius, box.low, box.high);
  const int width = box.high.x - box.low.x + 1;
  const auto rises = [&](std::uint32_t voxel) {
    const Voxel v = voxel_at(scan.measured.blocks[voxel / kBlockVoxels], voxel % kBlockVoxels);
    const int column = (v.y - box.low.y) * width + v.x - box.low.x;
    return v.z >= lowest[static_cast<std::size_t>(column)] + config.min_rise_voxels;
  };
  const auto risen = static_cast<std::size_t>(std::ranges::count_if(voxels, rises));
  return 4 * risen >= voxels.size();
}

/// Counts what a component holds of the classes, and says whether it moves.
void judge(const VoxelizedScan& scan, const ArrivalClasses& classes, const Ground& ground,
           const Config& config, Component& component) {
  double seeds = 0, fresh = 0, aged = 0;
  for (const std::uint32_t voxel : component.voxels) {
    const std::uint32_t block = voxel / kBlockVoxels, cell = voxel % kBlockVoxels;
    if (classes.aged[block].test(cell)) ++aged;
    if (!classes.seeds[block].test(cell)) continue;
    ++seeds;
    if (classes.fresh[block].test(cell)) ++fresh;
  }
  const auto voxels = static_cast<double>(component.voxels.size());
  component.seed_share = seeds / voxels;
  const bool is_pure = 2 * seeds >= voxels;
  const bool enough =
      seeds >= config.min_seeds_voxels || (is_pure && seeds >= config.min_pure_seeds_voxels);
  const bool is_too_old = !is_pure && aged > config.max_aged_share * voxels;
  if (!enough || component.seed_share < config.min_seed_share ||
      fresh < config.min_fresh_share * seeds || is_too_old) {
    return;
  }
  const Box box = box_of(scan, component.voxels);
  const double max_extent_m =
      is_pure ? std::max(config.max_extent_m, config.max_pure_extent_m) : config.max_extent_m;
  component.moves = has_size_of_object(box, max_extent_m, config) &&
                    rises_from_ground(scan, component.voxels, box, ground, config);
}

/// Leaves of a component what is near its seeds and not standing. `none` holds no voxel, before and
/// afterwards.
void cut_growth(const ArrivalClasses& classes, const Config& config, ScanMasks& none,
                Surroundings& surroundings, std::vector<std::uint32_t>& voxels) {
  std::vector<std::uint32_t> first;
  for (const std::uint32_t voxel : voxels) {
    const std::uint32_t block = voxel / kBlockVoxels, cell = voxel % kBlockVoxels;
    const bool is_seed = classes.seeds[block].test(cell);
    if (is_seed) first.push_back(voxel);
    if (is_seed || !classes.standing[block].test(cell)) none[block].set(cell);
  }
  const auto steps = static_cast<std::size_t>(config.max_growth_m / config.map.voxel_size_m);
  const auto none_in = [&](std::uint32_t slot) -> BlockMask& { return none[slot]; };
  std::vector<std::uint32_t> near = take_connected(first, steps, none_in, surroundings);
  for (const std::uint32_t voxel : voxels) none[voxel / kBlockVoxels] = {};
  voxels = std::move(near);
}

/// The voxels of components: seeds, and voxels that are neither settled nor low.
class Candidates {
 public:
  Candidates(const VoxelizedScan& scan, const ArrivalClasses& classes, LowVoxels& low)
      : scan_(scan),
        classes_(classes),
        low_(low),
        remaining_(scan.occupied.size()),
        asked_(scan.occupied.size()) {}

  /// Returns those of a block; what is taken out of it stays out.
  BlockMask& operator()(std::uint32_t slot) {
    if (asked_[slot] == 0) {
      asked_[slot] = 1;
      const BlockMask still = classes_.settled[slot] | low_.in(slot);
      remaining_[slot] = classes_.seeds[slot] | without(scan_.occupied[slot], still);
    }
    return remaining_[slot];
  }

 private:
  const VoxelizedScan& scan_;
  const ArrivalClasses& classes_;
  LowVoxels& low_;
  ScanMasks remaining_;
  std::vector<std::uint8_t> asked_;
};

/// Returns those of the low voxels that lie straight under an object and are not settled, or
/// diagonally and are not aged.
ScanMasks feet_of(const VoxelizedScan& scan, const ArrivalClasses& classes,
                  const ScanMasks& objects, LowVoxels& low) {
  ScanMasks feet(objects.size());
  Surroundings surroundings(scan);
  for (std::uint32_t slot = 0; slot < objects.size(); ++slot) {
    for_each_cell(objects[slot], [&](std::uint32_t cell) {
      surroundings.for_around(slot * kBlockVoxels + cell, -1, -1,
                              [&](std::uint32_t below, std::uint32_t below_cell) {
                                constexpr std::uint32_t kXY = kBlockSide * kBlockSide - 1;
                                const bool is_straight = ((below_cell ^ cell) & kXY) == 0;
                                const auto& still = is_straight ? classes.settled : classes.aged;
                                if (!low.in(below).test(below_cell)) return;
                                if (!still[below].test(below_cell)) feet[below].set(below_cell);
                              });
    });
  }
  return feet;
}

}  // namespace

std::vector<Component> find_components(const VoxelizedScan& scan, const ArrivalClasses& classes,
                                       const Ground& ground, LowVoxels& low, const Config& config) {
  Candidates remaining(scan, classes, low);
  Surroundings surroundings(scan);
  ScanMasks none(classes.seeds.size());
  std::vector<Component> components;
  for (std::uint32_t slot = 0; slot < classes.seeds.size(); ++slot) {
    for_each_cell(classes.seeds[slot], [&](std::uint32_t cell) {
      const std::array first = {static_cast<std::uint32_t>(slot * kBlockVoxels + cell)};
      Component found{take_connected(first, kAnySteps, remaining, surroundings)};
      if (found.voxels.empty()) return;  // taken with another seed
      judge(scan, classes, ground, config, found);
      if (found.moves) cut_growth(classes, config, none, surroundings, found.voxels);
      components.push_back(std::move(found));
    });
  }
  return components;
}

Box box_of(const VoxelizedScan& scan, const std::vector<std::uint32_t>& voxels) {
  constexpr int kMax = std::numeric_limits<int>::max();
  Voxel low{kMax, kMax, kMax}, high{-kMax, -kMax, -kMax};
  for (const std::uint32_t voxel : voxels) {
    const Voxel v = voxel_at(scan.measured.blocks[voxel / kBlockVoxels], voxel % kBlockVoxels);
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return {low, high};
}

Motion motion_of(const VoxelizedScan& scan, const ArrivalClasses& classes, LowVoxels& low,
                 std::vector<Component> components) {
  Motion motion{std::move(components), ScanMasks(scan.occupied.size()), {}};
  for (const Component& component : motion.components) {
    if (!component.moves) continue;
    for (const std::uint32_t voxel : component.voxels) {
      motion.objects[voxel / kBlockVoxels].set(voxel % kBlockVoxels);
    }
  }
  motion.feet = feet_of(scan, classes, motion.objects, low);
  return motion;
}

}  // namespace mosbench::hmm_mos_plus
