#include "core/hmm_mos_plus/objects.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace mosbench::hmm_mos_plus {
namespace {

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

/// Moves a voxel and all that are connected with it out of `left`.
std::vector<std::uint32_t> take_connected(std::uint32_t first, ScanMasks& left,
                                          Surroundings& surroundings) {
  std::vector<std::uint32_t> taken;
  const auto take = [&](std::uint32_t slot, std::uint32_t cell) {
    if (!left[slot].test(cell)) return;
    left[slot].words[cell >> 6] &= ~(std::uint64_t{1} << (cell & 63));
    taken.push_back(slot * kBlockVoxels + cell);
  };
  take(first / kBlockVoxels, first % kBlockVoxels);
  for (std::size_t next = 0; next < taken.size(); ++next) {
    surroundings.for_around(taken[next], -1, 1, take);
  }
  return taken;
}

struct Box {
  Voxel low, high;  // both included
};

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

bool has_size_of_object(const Box& box, const Config& config) {
  const double size_m = config.map.voxel_size_m;
  const Voxel& low = box.low;
  const Voxel& high = box.high;
  return std::max(high.x - low.x, high.y - low.y) * size_m <= config.max_extent_m &&
         (high.z - low.z) * size_m <= config.max_height_m;
}

/// Whether a component is more than a strip of ground.
bool rises_from_ground(const Box& box, const Ground& ground, const Config& config) {
  const int r = static_cast<int>(config.rise_radius_m / config.map.voxel_size_m);
  const std::int32_t lowest =
      ground.lowest_between({box.low.x - r, box.low.y - r, 0}, {box.high.x + r, box.high.y + r, 0});
  return box.high.z >= lowest + config.min_rise_voxels;
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
  if (seeds < config.min_seeds_voxels || component.seed_share < config.min_seed_share ||
      fresh < config.min_fresh_share * seeds || aged > config.max_aged_share * voxels) {
    return;
  }
  const Box box = box_of(scan, component.voxels);
  component.moves = has_size_of_object(box, config) && rises_from_ground(box, ground, config);
}

}  // namespace

std::vector<Component> components_of(const VoxelizedScan& scan, const ArrivalClasses& classes,
                                     const ScanMasks& others, const Ground& ground,
                                     const Config& config) {
  const ScanMasks& seeds = classes.seeds;
  ScanMasks left = others;
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = left[i] | seeds[i];
  Surroundings surroundings(scan);
  std::vector<Component> components;
  for (std::uint32_t slot = 0; slot < seeds.size(); ++slot) {
    for_each_cell(seeds[slot], [&](std::uint32_t cell) {
      Component found{take_connected(slot * kBlockVoxels + cell, left, surroundings)};
      if (found.voxels.empty()) return;  // taken with another seed
      judge(scan, classes, ground, config, found);
      components.push_back(std::move(found));
    });
  }
  return components;
}

ScanMasks feet_of(const VoxelizedScan& scan, const ScanMasks& objects, const ScanMasks& low) {
  ScanMasks feet(objects.size());
  Surroundings surroundings(scan);
  for (std::uint32_t slot = 0; slot < objects.size(); ++slot) {
    for_each_cell(objects[slot], [&](std::uint32_t cell) {
      surroundings.for_around(slot * kBlockVoxels + cell, -1, -1,
                              [&](std::uint32_t below, std::uint32_t below_cell) {
                                if (low[below].test(below_cell)) feet[below].set(below_cell);
                              });
    });
  }
  return feet;
}

}  // namespace mosbench::hmm_mos_plus
