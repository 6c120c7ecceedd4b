#include "core/methods/hmm_mos/median.hpp"

#include <algorithm>
#include <array>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos {
namespace {

constexpr int kSide = kBlockSide + 2;

/// Votes of a block and one voxel around it; -1 where no voxel is occupied.
class VoteHalo {
 public:
  VoteHalo(const VoxelizedScan& scan, const VoteField& votes, const BlockIndex& centre) {
    values_.fill(-1);
    for_each_neighbour(centre, [&](std::size_t, const BlockIndex& block) {
      const BlockMask* occupied = scan.occupied_in(block);
      if (occupied != nullptr) copy(*occupied, votes.find(block), block, centre);
    });
  }

  std::int16_t median_at(std::uint32_t cell) const {
    const int x = static_cast<int>(cell & 7), y = static_cast<int>((cell >> 3) & 7),
              z = static_cast<int>(cell >> 6);
    std::array<std::int16_t, 27> found;
    std::size_t count = 0, zeros = 0;
    for (int dz = 0; dz < 3; ++dz) {
      for (int dy = 0; dy < 3; ++dy) {
        for (int dx = 0; dx < 3; ++dx) {
          const std::int16_t value = values_[position(x + dx, y + dy, z + dz)];
          if (value < 0) continue;
          zeros += value == 0;
          found[count++] = value;
        }
      }
    }
    if (zeros * 2 > count) return 0;
    std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count));
    if (count % 2 == 1) return found[count / 2];
    return static_cast<std::int16_t>((found[count / 2 - 1] + found[count / 2]) / 2);
  }

 private:
  static std::size_t position(int x, int y, int z) {
    return static_cast<std::size_t>((z * kSide + y) * kSide + x);
  }

  void copy(const BlockMask& occupied, const VoteField::Block* votes, const BlockIndex& block,
            const BlockIndex& centre) {
    for_each_cell(occupied, [&](std::uint32_t cell) {
      const Voxel v = voxel_at(block, cell);
      const int x = v.x - centre.x * kBlockSide + 1, y = v.y - centre.y * kBlockSide + 1,
                z = v.z - centre.z * kBlockSide + 1;
      if (x < 0 || y < 0 || z < 0 || x >= kSide || y >= kSide || z >= kSide) return;
      values_[position(x, y, z)] = votes == nullptr ? std::int16_t{0} : (*votes)[cell];
    });
  }

  std::array<std::int16_t, kSide * kSide * kSide> values_;
};

BlockMask nonzero(const VoteField::Block& votes) {
  BlockMask mask;
  for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
    if (votes[cell] != 0) mask.set(cell);
  }
  return mask;
}

}  // namespace

VoteField median_filter(const VoxelizedScan& scan, const VoteField& votes, ThreadPool& pool) {
  VoxelSet voted;
  for (std::size_t i = 0; i < votes.blocks.size(); ++i) {
    voted.masks[voted.insert(votes.blocks[i])] = nonzero(votes.values[i]);
  }
  const std::vector<std::uint32_t> slots = slots_within(scan, voted, 1);
  std::vector<VoteField::Block> filtered(slots.size());
  std::vector<std::uint8_t> any(slots.size());
  for_each_block_near(voted, 1, scan, slots, pool,
                      [&](std::size_t i, const HaloRows&, const BlockMask& reach) {
                        filtered[i].fill(0);
                        if (!reach.any()) return;
                        const VoteHalo halo(scan, votes, scan.measured.blocks[slots[i]]);
                        for_each_cell(reach, [&](std::uint32_t cell) {
                          filtered[i][cell] = halo.median_at(cell);
                          any[i] |= filtered[i][cell] != 0;
                        });
                      });
  VoteField field;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (any[i] != 0) field.add(scan.measured.blocks[slots[i]], filtered[i]);
  }
  return field;
}

}  // namespace mosbench::hmm_mos
