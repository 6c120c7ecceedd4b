#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxel/distance_field.hpp"
#include "core/voxel/voxel.hpp"

namespace mosbench::hmm_mos {

/// States S of a block's voxels. In neither mask: unobserved.
struct BlockStates {
  BlockMask occupied, free;
};

/// Memory for the numbers of a block's beliefs.
struct BeliefNumbers {
  alignas(64) std::array<float, kBlockVoxels> occupied;
};

/// The beliefs p(occupied) of a block's voxels. Only voxels with a source in reach when they were
/// seen last have a number; the others are at 0, or still at the 0.5 of a voxel never seen.
class BlockBeliefs {
 public:
  const BlockMask& seen() const { return seen_; }
  /// Returns p(occupied); `numbers` are those that the block was updated with.
  float at(std::uint32_t cell, const BeliefNumbers& numbers) const {
    return numbered_.test(cell) ? numbers.occupied[cell] : seen_.test(cell) ? 0.0F : 0.5F;
  }
  /// Makes voxels never seen.
  void forget(const BlockMask& voxels) {
    seen_ = without(seen_, voxels);
    numbered_ = without(numbered_, voxels);
  }

 private:
  friend class BeliefFilter;
  BlockMask seen_, numbered_;
};

/// Returns the distance, in sigmas, beyond which the likelihood of an occupied voxel cannot change
/// a state.
double likelihood_reach_sigmas(double transition_epsilon, double min_state_probability);

/// The three-state hidden Markov model of the paper (III). After its first observation a voxel is
/// never unobserved again, so the belief x is one number, p(occupied); a voxel that was never seen
/// has p = 0.5.
class BeliefFilter {
 public:
  /// epsilon in (0, 0.5), p_min in [0.5, 1); metres.
  BeliefFilter(double voxel_size_m, double sigma_m, double transition_epsilon,
               double min_state_probability);

  /// Voxels per axis beyond which a likelihood cannot change a state.
  int radius() const { return radius_; }

  /// x_k = eta B A x_{k-1}, B = diag(0, L, 1 - L), L = exp(-d^2 / (2 sigma_o^2)), and S where p >
  /// p_min (paper, III), for the observed voxels of a block, whose `numbers` are always the same.
  void update(const BlockMask& observed, const BlockDistances& distances, BlockBeliefs& beliefs,
              BeliefNumbers& numbers, BlockStates& states) const;

  /// The same for voxels without a source in reach: they are certainly free.
  static void update_far(const BlockMask& observed, BlockBeliefs& beliefs, BlockStates& states);

  /// The numbers of one filter step.
  struct Step {
    float epsilon, keep, min_probability;  ///< keep = 1 - 2 epsilon
  };

 private:
  int radius_ = 0;
  Step step_;
  std::vector<float> likelihood_;  // by squared distance in voxels, up to far_squared(radius)
};

}  // namespace mosbench::hmm_mos
