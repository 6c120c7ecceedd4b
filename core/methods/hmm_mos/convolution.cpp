#include "core/methods/hmm_mos/convolution.hpp"

#include <utility>
#include <vector>

#include "core/voxel/neighbourhood.hpp"

namespace mosbench::hmm_mos {

VoteField convolve(const VoxelizedScan& scan, std::span<const std::uint32_t> slots,
                   const VoxelSet& changed, const VoxelSet& known, int kernel_width_voxels,
                   ThreadPool& pool) {
  const int radius = radius_of(kernel_width_voxels);
  const int volume = kernel_width_voxels * kernel_width_voxels * kernel_width_voxels;
  // With a delay of w_g scans or more a voxel may be forgotten since it changed.
  const VoxelSet voters = in_both(changed, known);
  std::vector<VoteField::Block> votes(slots.size());
  std::vector<std::uint8_t> any(slots.size());
  for_each_block_near(voters, radius, scan, slots, pool,
                      [&](std::size_t i, const HaloRows& voter_rows, const BlockMask& reach) {
                        votes[i].fill(0);
                        if (!reach.any()) return;
                        HaloRows known_rows;
                        gather_around(known, scan.measured.blocks[slots[i]], radius, known_rows);
                        for_each_cell(reach, [&](std::uint32_t cell) {
                          const int unknown = volume - count_around(known_rows, cell);
                          const int sum = count_around(voter_rows, cell) - unknown;
                          if (sum <= 0) return;
                          votes[i][cell] = static_cast<std::int16_t>(sum);
                          any[i] = 1;
                        });
                      });
  VoteField field;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (any[i] != 0) field.add(scan.measured.blocks[slots[i]], votes[i]);
  }
  return field;
}

VoxelSet beside_unknown(const VoxelizedScan& scan, std::span<const std::uint32_t> slots,
                        const VoxelSet& known, int kernel_width_voxels, ThreadPool& pool) {
  std::vector<BlockMask> beside(slots.size());
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows rows;
    for (std::size_t i = begin; i < end; ++i) {
      gather_around(known, scan.measured.blocks[slots[i]], radius_of(kernel_width_voxels), rows);
      invert(rows);
      beside[i] = dilate(rows) & scan.occupied[slots[i]];
    }
  });
  return set_of(scan, slots, beside);
}

void LocalWindow::join(VoteField votes) {
  window_.push_back(std::move(votes));
  if (window_.size() > scans_) window_.pop_front();
}

SumField LocalWindow::sums(const VoxelizedScan& scan) const {
  SumField sums;
  for (std::size_t slot = 0; slot < scan.measured.block_count(); ++slot) {
    const BlockIndex& block = scan.measured.blocks[slot];
    SumField::Block sum;
    bool any = false;
    for (const VoteField& votes : window_) {
      const VoteField::Block* values = votes.find(block);
      if (values == nullptr) continue;
      if (!any) sum.fill(0);
      for_each_cell(scan.occupied[slot], [&](std::uint32_t cell) { sum[cell] += (*values)[cell]; });
      any = true;
    }
    if (any) sums.add(block, sum);
  }
  return sums;
}

std::size_t LocalWindow::memory_bytes() const {
  std::size_t bytes = 0;
  for (const VoteField& votes : window_) {
    bytes += votes.values.capacity() * sizeof(VoteField::Block) + votes.table.memory_bytes();
  }
  return bytes;
}

}  // namespace mosbench::hmm_mos
