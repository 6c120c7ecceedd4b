#include "core/hmm_mos/local_window.hpp"

#include <utility>

namespace mosbench::hmm_mos {

void LocalWindow::join(ScoreField scores) {
  window_.push_back(std::move(scores));
  if (window_.size() > scans_) window_.pop_front();
}

SumField LocalWindow::sums(const VoxelizedScan& scan) const {
  SumField sums;
  for (std::size_t slot = 0; slot < scan.measured.block_count(); ++slot) {
    const BlockIndex& block = scan.measured.blocks[slot];
    SumField::Block sum;
    bool any = false;
    for (const ScoreField& scores : window_) {
      const ScoreField::Block* values = scores.find(block);
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
  for (const ScoreField& scores : window_) {
    bytes += scores.values.capacity() * sizeof(ScoreField::Block) + scores.table.memory_bytes();
  }
  return bytes;
}

}  // namespace mosbench::hmm_mos
