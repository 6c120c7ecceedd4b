#pragma once

#include <span>
#include <vector>

#include "bench/staged_scans.hpp"
#include "core/methods/hmm_mos/hmm.hpp"
#include "core/voxel/distance_field.hpp"

namespace mosbench {
using namespace hmm_mos;

/// The observed blocks of the last scan that have a source within reach, and the sources of their
/// distance fields.
class NearBlocks {
 public:
  explicit NearBlocks(const StagedScans& staged);

  std::size_t size() const { return observed_.size(); }
  std::size_t with_source() const { return with_source_; }
  const BeliefFilter& filter() const { return filter_; }
  const DistanceField& field() const { return field_; }
  const BlockIndex& block(std::size_t i) const { return *blocks_[i]; }
  const BlockMask& observed(std::size_t i) const { return *observed_[i]; }
  std::span<const SourceBlock* const> sources(std::size_t i) const {
    return std::span(sources_).subspan(i * cube_, cube_);
  }

  /// Computes the distances of block i; `column` must be given the blocks in order.
  void find_distances(std::size_t i, ColumnDistances& column, BlockDistances& distances) const {
    column.find(block(i), observed(i), sources(i), distances);
  }

  /// Checks the distances of some cells against the nearest source over all pairs.
  bool equals_all_pairs() const;

 private:
  BeliefFilter filter_;
  DistanceField field_;
  SourceGrid grid_;
  std::size_t cube_;
  std::size_t with_source_ = 0;
  std::vector<const BlockIndex*> blocks_;
  std::vector<const BlockMask*> observed_;
  std::vector<const SourceBlock*> sources_;
};

}  // namespace mosbench
