#pragma once

#include <vector>

#include "core/distance_field.hpp"
#include "core/voxel.hpp"

namespace mosbench {

/// Most probable states of a block's voxels. In neither mask: unobserved.
struct BlockStates {
  BlockMask occupied, free;
};

/// The three-state filter. After its first observation a voxel is never unobserved again, so the
/// belief is one number, p(occupied); a voxel that was never seen has p = 0.5.
class BeliefFilter {
 public:
  /// epsilon in (0, 0.5), p_min in [0.5, 1); metres.
  BeliefFilter(double voxel_size_m, double sigma_m, double transition_epsilon,
               double min_state_probability);

  /// Voxels per axis beyond which a likelihood cannot change a state.
  int radius() const { return radius_; }

  /// algorithm step 3 for the observed voxels of a block. `beliefs` holds 512 numbers, read only
  /// where `seen`; `states` and `beliefs` are updated.
  void update(const BlockMask& observed, const BlockMask& seen, const BlockDistances& distances,
              float* beliefs, BlockStates& states) const;

  /// The same for a block without a source in reach: every observed voxel is certainly free.
  /// `beliefs` may be null when all of them are zero.
  static void update_far(const BlockMask& observed, float* beliefs, BlockStates& states);

 private:
  int radius_ = 0;
  float epsilon_ = 0, keep_ = 0, min_probability_ = 0;
  std::vector<float> likelihood_;  // by squared distance in voxels; beyond its end 0
};

}  // namespace mosbench
