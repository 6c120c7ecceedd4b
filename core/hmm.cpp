#include "core/hmm.hpp"

#include <cmath>

namespace mosbench {

BeliefFilter::BeliefFilter(double voxel_size_m, double sigma_m, double transition_epsilon,
                           double min_state_probability)
    : epsilon_(static_cast<float>(transition_epsilon)),
      keep_(static_cast<float>(1 - 2 * transition_epsilon)),
      min_probability_(static_cast<float>(min_state_probability)) {
  // One observation at likelihood L leaves even a certainly occupied voxel at p < L / epsilon.
  // Below this L that lies thousands of times under 1 - p_min: no state can depend on it.
  const double negligible = transition_epsilon * (1 - min_state_probability) * 3.2e-4;
  const double ratio = voxel_size_m / sigma_m;
  for (int n = 0;; ++n) {
    const double likelihood = std::exp(-n * ratio * ratio / 2);  // L = exp(-d^2 / (2 sigma^2))
    if (likelihood < negligible) break;
    likelihood_.push_back(static_cast<float>(likelihood));
  }
  radius_ = static_cast<int>(std::sqrt(static_cast<double>(likelihood_.size() - 1)));
}

void BeliefFilter::update(const BlockMask& observed, const BlockMask& seen,
                          const BlockDistances& distances, float* beliefs,
                          BlockStates& states) const {
  const std::size_t reach = likelihood_.size();
  for (std::uint32_t z = 0; z < 8; ++z) {
    std::uint64_t occupied = 0, free = 0;
    for (std::uint64_t left = observed.words[z]; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(left));
      const std::uint32_t cell = z * 64 + bit;
      const std::uint16_t n = distances[cell];
      float p = 0.0f;
      if (n < reach) {
        // x <- A x, then x <- normalize(diag(0, L, 1 - L) x), written for p(occupied) alone.
        const float prior = seen.test(cell) ? beliefs[cell] : 0.5f;
        const float q = epsilon_ + keep_ * prior;
        const float hit = likelihood_[n] * q;
        p = hit / (hit + (1.0f - likelihood_[n]) * (1.0f - q));
      }
      beliefs[cell] = p;
      occupied |= std::uint64_t{p > min_probability_} << bit;
      free |= std::uint64_t{1.0f - p > min_probability_} << bit;
    }
    states.occupied.words[z] = (states.occupied.words[z] & ~free) | occupied;
    states.free.words[z] = (states.free.words[z] & ~occupied) | free;
  }
}

void BeliefFilter::update_far(const BlockMask& observed, float* beliefs, BlockStates& states) {
  states.occupied = without(states.occupied, observed);
  states.free = states.free | observed;
  if (beliefs == nullptr) return;
  for_each_cell(observed, [&](std::uint32_t cell) { beliefs[cell] = 0.0f; });
}

}  // namespace mosbench
