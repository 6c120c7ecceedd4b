#include "core/methods/hmm_mos/hmm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/methods/hmm_mos/change_detection.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

/// The belief of the paper (III), all three states in double precision.
struct ThreeStates {
  double unobserved = 1, occupied = 0, free = 0;
  enum class State { kUnobserved, kOccupied, kFree } state = State::kUnobserved;

  void observe(double squared_voxels, double voxel_size_m, double sigma_m, double e, double p_min) {
    const double distance_sq_m2 = squared_voxels * voxel_size_m * voxel_size_m;
    const double likelihood = std::exp(-distance_sq_m2 / (2 * sigma_m * sigma_m));
    const double u = (1 - 2 * e) * unobserved;
    const double o = e * unobserved + (1 - e) * occupied + e * free;
    const double f = e * unobserved + e * occupied + (1 - e) * free;
    const double sum = 0 * u + likelihood * o + (1 - likelihood) * f;
    unobserved = 0;
    occupied = likelihood * o / sum;
    free = (1 - likelihood) * f / sum;
    const bool is_free = free > occupied;
    if ((is_free ? free : occupied) > p_min) state = is_free ? State::kFree : State::kOccupied;
  }
};

/// What the map keeps of a block for the filter.
struct Block {
  BlockBeliefs beliefs;
  BeliefNumbers numbers;
  BlockStates states;

  void update(const BeliefFilter& filter, const BlockMask& observed,
              const BlockDistances& distances) {
    filter.update(observed, distances, beliefs, numbers, states);
  }
  float belief(std::uint32_t cell) const { return beliefs.at(cell, numbers); }
};

struct HmmSetting {
  double voxel_size_m, sigma_m, epsilon, p_min;
};
const HmmSetting kSettings[] = {{0.2, 0.2, 0.005, 0.99},   {0.25, 0.25, 0.005, 0.99},
                                {0.2, 0.35, 0.005, 0.999}, {0.3, 0.2, 0.005, 0.95},
                                {0.2, 0.8, 0.01, 0.9},     {0.2, 0.1, 0.2, 0.6},
                                {0.25, 0.25, 0.001, 0.5},  {0.2, 0.2, 0.005, 0.99999}};

TEST(BeliefFilter, FollowsTheThreeStatesOfThePaper) {
  std::mt19937 random(41);
  for (const HmmSetting& s : kSettings) {
    const BeliefFilter filter(s.voxel_size_m, s.sigma_m, s.epsilon, s.p_min);
    const int beyond = (filter.radius() + 1) * (filter.radius() + 1);
    std::vector<ThreeStates> twins(kBlockVoxels);
    Block block;
    block.numbers.occupied.fill(0.75F);  // read where it is not valid would show
    std::size_t occupied = 0, free = 0;
    for (int scan = 0; scan < 200; ++scan) {
      BlockMask observed;
      BlockDistances distances;
      for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
        // Often at the source, sometimes near, sometimes out of reach.
        const auto kind = random() % 8;
        const int n = kind < 3   ? 0
                      : kind < 6 ? static_cast<int>(random() % static_cast<unsigned>(beyond))
                                 : beyond;
        distances.squared[cell] = static_cast<std::uint16_t>(n);
        if (n < beyond) distances.near.set(cell);
        if (random() % 2 == 0) continue;
        observed.set(cell);
        twins[cell].observe(n, s.voxel_size_m, s.sigma_m, s.epsilon, s.p_min);
      }
      block.update(filter, observed, distances);
      for (std::uint32_t cell = 0; cell < kBlockVoxels; ++cell) {
        const ThreeStates& twin = twins[cell];
        if (!block.beliefs.seen().test(cell)) continue;
        ASSERT_NEAR(twin.occupied + twin.free, 1.0, 1e-12);
        // A likelihood taken as zero leaves p < L / epsilon < 3.2e-4 (1 - p_min), and then shifts a
        // prior by as much; a few roundings of single precision come on top.
        ASSERT_NEAR(block.belief(cell), twin.occupied, 4e-4 * (1 - s.p_min) / s.epsilon + 1e-5);
        // States may differ only where p is that close to p_min: assert them away from it.
        const double margin =
            std::abs(std::max(twin.occupied, twin.free) - s.p_min) / (1 - s.p_min);
        if (margin < 1e-2) continue;
        if (block.states.occupied.test(cell) != (twin.state == ThreeStates::State::kOccupied)) {
          // A state kept from a scan within the margin.
          ASSERT_LE(std::max(twin.occupied, twin.free), s.p_min);
          twins[cell].state = block.states.occupied.test(cell) ? ThreeStates::State::kOccupied
                              : block.states.free.test(cell)   ? ThreeStates::State::kFree
                                                               : ThreeStates::State::kUnobserved;
        }
        ASSERT_FALSE(block.states.occupied.test(cell) && block.states.free.test(cell));
        occupied += block.states.occupied.test(cell);
        free += block.states.free.test(cell);
      }
    }
    EXPECT_GT(occupied, 1000U);
    EXPECT_GT(free, 1000U);
  }
}

TEST(BeliefFilter, OneHitIsCertainAndOneMissIsFree) {
  const BeliefFilter filter(0.2, 0.2, 0.005, 0.99);
  BlockMask observed;
  observed.set(0);
  observed.set(1);
  BlockDistances distances{.near = observed, .squared = {}};
  distances.squared[1] = 25;
  Block block;
  block.update(filter, observed, distances);
  EXPECT_EQ(block.belief(0), 1.0F);
  EXPECT_TRUE(block.states.occupied.test(0));
  EXPECT_TRUE(block.states.free.test(1));
  EXPECT_FALSE(block.states.occupied.test(2) || block.states.free.test(2));
}

/// First observation: p(occupied) is the likelihood itself, exp(-n / 2) for sigma = voxel size.
TEST(BeliefFilter, FirstObservationIsTheLikelihood) {
  const BeliefFilter filter(0.25, 0.25, 0.005, 0.99);
  BlockMask observed;
  BlockDistances distances{};
  for (std::uint32_t n = 0; n < 20; ++n) {
    observed.set(n);
    distances.near.set(n);
    distances.squared[n] = static_cast<std::uint16_t>(n);
  }
  Block block;
  block.update(filter, observed, distances);
  for (std::uint32_t n = 0; n < 20; ++n) EXPECT_NEAR(block.belief(n), std::exp(-0.5 * n), 1e-6);
  for (std::uint32_t n = 0; n < 20; ++n) {
    // exp(-n / 2) < 0.01 from n = 10 on.
    EXPECT_EQ(block.states.free.test(n), n >= 10) << n;
    EXPECT_EQ(block.states.occupied.test(n), n == 0) << n;
  }
}

/// exp(-n / 2) = p_min is met by no n, but 1 - L at p_min = 0.5 decides strictly.
TEST(BeliefFilter, StateNeedsMoreThanTheMinimumProbability) {
  const double sigma_m = 1.0 / std::sqrt(2 * std::log(2.0));  // L(n = 1) = 0.5
  const BeliefFilter filter(1.0, sigma_m, 0.25, 0.5);
  BlockMask observed;
  observed.set(0);
  BlockDistances distances{.near = observed, .squared = {}};
  distances.squared[0] = 1;
  Block block;
  block.update(filter, observed, distances);
  ASSERT_EQ(block.belief(0), 0.5F);
  EXPECT_FALSE(block.states.occupied.any() || block.states.free.any());
}

TEST(BeliefFilter, FarFromEverySourceIsFree) {
  const BeliefFilter filter(0.25, 0.25, 0.005, 0.99);
  BlockMask both, observed;
  both.set(3);
  both.set(4);
  observed.set(3);
  Block block;
  block.update(filter, both, {.near = both, .squared = {}});
  ASSERT_EQ(block.belief(3), 1.0F);
  BeliefFilter::update_far(observed, block.beliefs, block.states);
  EXPECT_EQ(block.belief(3), 0.0F);
  EXPECT_EQ(block.belief(4), 1.0F);
  EXPECT_EQ(block.belief(5), 0.5F) << "never seen";
  EXPECT_TRUE(block.states.free.test(3) && block.states.occupied.test(4));
  EXPECT_FALSE(block.states.occupied.test(3) || block.states.free.test(4));
  block.beliefs.forget(both);
  EXPECT_EQ(block.belief(4), 0.5F) << "as if never seen";
}

TEST(ChangeDetection, OnlySwitchesBetweenFreeAndOccupiedCount) {
  BlockStates before, after;
  before.free.set(0);
  after.occupied.set(0);
  before.occupied.set(1);
  after.free.set(1);
  after.occupied.set(2);
  after.free.set(3);
  before.free.set(4);
  after.free.set(4);
  before.occupied.set(5);
  after.occupied.set(5);
  BlockMask expected;
  expected.set(0);
  expected.set(1);
  EXPECT_EQ(detect_changes(before, after), expected);
}

}  // namespace
}  // namespace mosbench
