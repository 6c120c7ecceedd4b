#include "core/methods/hmm_mos/hmm.hpp"

#include <cmath>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

namespace mosbench::hmm_mos {
namespace {

/// One observation at likelihood L leaves even a certainly occupied voxel at p < L / epsilon. Below
/// the L returned, this posterior is under 3.2e-4 (1 - p_min), so treating it as 0 cannot change a
/// state.
double negligible_likelihood(double transition_epsilon, double min_state_probability) {
  return transition_epsilon * (1 - min_state_probability) * 3.2e-4;
}

struct Cells {
  const BlockMask &in_reach, &seen, &numbered;
  const std::uint16_t* distances;
  const float* likelihood;
};

/// Filters rows of eight cells; cells out of reach keep their belief and state.
MOSBENCH_MULTIARCH void filter_cells(const BeliefFilter::Step& step, const Cells& cells,
                                     float* beliefs, BlockStates& states) {
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    std::uint64_t occupied = 0, free = 0;
    for (std::size_t y = 0; y < kBlockSide; ++y) {
      const auto row_of = [&](const BlockMask& mask) {
        return static_cast<std::uint32_t>(mask.words[z] >> (8 * y) & 0xFFu);
      };
      const std::uint32_t in_reach = row_of(cells.in_reach);
      if (in_reach == 0) continue;
      const std::size_t first = (z * kBlockSide + y) * kBlockSide;
      FloatLanes likelihood;
      for (std::size_t x = 0; x < kLanes; ++x) {
        likelihood[x] = cells.likelihood[cells.distances[first + x]];
      }
      const auto belief = load<FloatLanes>(beliefs + first);
      const FloatLanes unseen = FloatLanes{} + 0.5f;
      const FloatLanes prior = lanes_of(row_of(cells.numbered))
                                   ? belief
                                   : (lanes_of(row_of(cells.seen)) ? FloatLanes{} : unseen);
      // x_k = eta B A x_{k-1} (paper, III): q = (A x)_occupied, B = diag(0, L, 1 - L), eta
      // normalises.
      const FloatLanes q = step.epsilon + step.keep * prior;
      const FloatLanes hit = likelihood * q;
      const FloatLanes p = hit / (hit + (1.0f - likelihood) * (1.0f - q));
      store(lanes_of(in_reach) ? p : belief, beliefs + first);
      occupied |= std::uint64_t{bits_of(p > step.min_probability) & in_reach} << (8 * y);
      free |= std::uint64_t{bits_of(1.0f - p > step.min_probability) & in_reach} << (8 * y);
    }
    states.occupied.words[z] = (states.occupied.words[z] & ~free) | occupied;
    states.free.words[z] = (states.free.words[z] & ~occupied) | free;
  }
}

}  // namespace

double likelihood_reach_sigmas(double transition_epsilon, double min_state_probability) {
  return std::sqrt(-2 * std::log(negligible_likelihood(transition_epsilon, min_state_probability)));
}

BeliefFilter::BeliefFilter(double voxel_size_m, double sigma_m, double transition_epsilon,
                           double min_state_probability)
    : step_{.epsilon = static_cast<float>(transition_epsilon),
            .keep = static_cast<float>(1 - 2 * transition_epsilon),
            .min_probability = static_cast<float>(min_state_probability)} {
  const double negligible = negligible_likelihood(transition_epsilon, min_state_probability);
  const double ratio = voxel_size_m / sigma_m;
  for (int n = 0;; ++n) {
    const double likelihood = std::exp(-n * ratio * ratio / 2);  // L = exp(-d^2 / (2 sigma_o^2))
    if (likelihood < negligible) break;
    likelihood_.push_back(static_cast<float>(likelihood));
  }
  radius_ = static_cast<int>(std::sqrt(static_cast<double>(likelihood_.size() - 1)));
  // Zeroes, up to the distance of cells that are not near.
  likelihood_.resize(static_cast<std::size_t>(far_squared(radius_)) + 1);
}

void BeliefFilter::update(const BlockMask& observed, const BlockDistances& distances,
                          BlockBeliefs& beliefs, BeliefNumbers& numbers,
                          BlockStates& states) const {
  const BlockMask in_reach = observed & distances.near;
  update_far(without(observed, in_reach), beliefs, states);
  filter_cells(
      step_,
      {in_reach, beliefs.seen_, beliefs.numbered_, distances.squared.data(), likelihood_.data()},
      numbers.occupied.data(), states);
  beliefs.seen_ = beliefs.seen_ | in_reach;
  beliefs.numbered_ = beliefs.numbered_ | in_reach;
}

void BeliefFilter::update_far(const BlockMask& observed, BlockBeliefs& beliefs,
                              BlockStates& states) {
  states.occupied = without(states.occupied, observed);
  states.free = states.free | observed;
  beliefs.seen_ = beliefs.seen_ | observed;
  beliefs.numbered_ = without(beliefs.numbered_, observed);
}

}  // namespace mosbench::hmm_mos
