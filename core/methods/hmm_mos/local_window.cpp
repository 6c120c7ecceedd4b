#include "core/methods/hmm_mos/local_window.hpp"

#include <utility>

namespace mosbench::hmm_mos {

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
