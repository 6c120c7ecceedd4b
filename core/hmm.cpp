#include "core/hmm.hpp"

#include <cmath>

namespace mosbench {
namespace {

/// One observation at likelihood L leaves even a certainly occupied voxel at p < L / epsilon. Below
/// this L that lies thousands of times under 1 - p_min: no state can depend on it.
double negligible_likelihood(double transition_epsilon, double min_state_probability) {
  return transition_epsilon * (1 - min_state_probability) * 3.2e-4;
}

}  // namespace

double likelihood_reach_sigmas(double transition_epsilon, double min_state_probability) {
  return std::sqrt(-2 * std::log(negligible_likelihood(transition_epsilon, min_state_probability)));
}

BeliefFilter::BeliefFilter(double voxel_size_m, double sigma_m, double transition_epsilon,
                           double min_state_probability)
    : epsilon_(static_cast<float>(transition_epsilon)),
      keep_(static_cast<float>(1 - 2 * transition_epsilon)),
      min_probability_(static_cast<float>(min_state_probability)) {
  const double negligible = negligible_likelihood(transition_epsilon, min_state_probability);
  const double ratio = voxel_size_m / sigma_m;
  for (int n = 0;; ++n) {
    const double likelihood = std::exp(-n * ratio * ratio / 2);  // L = exp(-d^2 / (2 sigma^2))
    if (likelihood < negligible) break;
    likelihood_.push_back(static_cast<float>(likelihood));
  }
  radius_ = static_cast<int>(std::sqrt(static_cast<double>(likelihood_.size() - 1)));
}

void BeliefFilter::update(const BlockMask& observed, const BlockMask& seen,
                          const BlockDistances& distances, BlockMask& nonzero,
                          BlockBeliefs& beliefs, BlockStates& states) const {
  const BlockMask in_reach = observed & cells_below(distances, likelihood_.size());
  update_far(without(observed, in_reach), nonzero, states);
  for (std::uint32_t z = 0; z < 8; ++z) {
    std::uint64_t occupied = 0, free = 0;
    for (std::uint64_t left = in_reach.words[z]; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(left));
      const std::uint32_t cell = z * 64 + bit;
      const float prior = nonzero.test(cell) ? beliefs.occupied[cell]
                          : seen.test(cell)  ? 0.0f
                                             : 0.5f;
      // x <- A x, then x <- normalize(diag(0, L, 1 - L) x), written for p(occupied) alone.
      const float likelihood = likelihood_[distances[cell]];
      const float q = epsilon_ + keep_ * prior;
      const float hit = likelihood * q;
      const float p = hit / (hit + (1.0f - likelihood) * (1.0f - q));
      beliefs.occupied[cell] = p;
      occupied |= std::uint64_t{p > min_probability_} << bit;
      free |= std::uint64_t{1.0f - p > min_probability_} << bit;
    }
    nonzero.words[z] |= in_reach.words[z];
    states.occupied.words[z] = (states.occupied.words[z] & ~free) | occupied;
    states.free.words[z] = (states.free.words[z] & ~occupied) | free;
  }
}

void BeliefFilter::update_far(const BlockMask& observed, BlockMask& nonzero, BlockStates& states) {
  states.occupied = without(states.occupied, observed);
  states.free = states.free | observed;
  nonzero = without(nonzero, observed);
}

}  // namespace mosbench
