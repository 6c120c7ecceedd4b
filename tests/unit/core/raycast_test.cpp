#include "core/voxel/raycast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "tests/voxel_twins.hpp"

namespace mosbench {
namespace {

/// Bresenham's line as raycast.hpp states it; stops at the first voxel beyond the range.
void walk(const Triple& s, const Triple& v, double voxel_size_m, double max_range_m,
          Triples& observed) {
  Triple d{}, g{}, e{}, q = s;
  int longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    d[axis] = std::abs(v[axis] - s[axis]);
    g[axis] = s[axis] < v[axis] ? 1 : -1;
    longest = std::max(longest, d[axis]);
  }
  e.fill(longest / 2);
  for (int step = 0; step <= longest; ++step) {
    const double x = (s[0] - q[0]) * voxel_size_m, y = (s[1] - q[1]) * voxel_size_m,
                 z = (s[2] - q[2]) * voxel_size_m;
    if (x * x + y * y + z * z > max_range_m * max_range_m) return;
    observed.insert(q);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      e[axis] -= d[axis];
      if (e[axis] < 0) {
        e[axis] += longest;
        q[axis] += g[axis];
      }
    }
  }
}

Triples walk_all(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                 double max_range_m) {
  Triples observed;
  for (const Triple& v : triples(measured)) {
    walk(triple(sensor), v, voxel_size_m, max_range_m, observed);
  }
  return observed;
}

/// The observed voxels; asserts that no block comes twice or empty.
Triples observed_by(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                    double max_range_m, RaycastScratch& scratch, ThreadPool& pool) {
  const RaySource source{measured, sensor, voxel_size_m, max_range_m};
  const VoxelList observed = raycast({&source, 1}, scratch, pool);
  VoxelSet unique;
  for (std::size_t i = 0; i < observed.blocks.size(); ++i) {
    EXPECT_EQ(unique.insert(observed.blocks[i]), i) << "a block comes twice";
    EXPECT_TRUE(observed.masks[i].any());
  }
  return triples(observed.blocks, observed.masks);
}

Triples observed_by(const VoxelSet& measured, const Voxel& sensor, double voxel_size_m,
                    double max_range_m) {
  RaycastScratch scratch;
  ThreadPool pool(1);
  return observed_by(measured, sensor, voxel_size_m, max_range_m, scratch, pool);
}

/// A set whose coordinates may be far apart.
VoxelSet wide_set(const std::vector<Voxel>& voxels) {
  VoxelSet set;
  for (const Voxel& v : voxels) set.masks[set.insert(block_of(v))].set(cell_of(v));
  return set;
}

TEST(Raycast, FollowsHandWorkedLines) {
  // d = (4, 2, 0), M = 4, errors start at 2: y turns negative in the second and fourth step.
  EXPECT_EQ(observed_by(voxel_set({{4, 2, 0}}), {}, 1.0, 100.0),
            (Triples{{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 1, 0}, {4, 2, 0}}));
  // d = (5, 3, 1), M = 5, errors start at 2.
  EXPECT_EQ(observed_by(voxel_set({{-5, 3, -1}}), {}, 1.0, 100.0),
            (Triples{{0, 0, 0}, {-1, 1, 0}, {-2, 1, 0}, {-3, 2, -1}, {-4, 2, -1}, {-5, 3, -1}}));
}

TEST(Raycast, LineToTheSensorsOwnVoxelIsThatVoxel) {
  EXPECT_EQ(observed_by(voxel_set({{-3, 9, 2}}), {-3, 9, 2}, 0.2, 20.0), (Triples{{-3, 9, 2}}));
}

TEST(Raycast, NothingMeasuredObservesNothing) {
  EXPECT_TRUE(observed_by(VoxelSet{}, {5, 5, 5}, 0.2, 20.0).empty());
}

TEST(Raycast, VoxelsExactlyAtTheRangeAreObserved) {
  EXPECT_EQ(observed_by(voxel_set({{6, 0, 0}}), {}, 0.5, 2.0),
            (Triples{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}));
  EXPECT_EQ(observed_by(voxel_set({{4, 0, 0}}), {}, 0.5, 2.0).size(), 5U);
  EXPECT_EQ(observed_by(voxel_set({{4, 0, 0}}), {}, 0.5, std::nextafter(2.0, 0.0)).size(), 4U);
}

TEST(Raycast, EqualsTheErrorTermWalkOnRandomScans) {
  std::mt19937 random(21);
  RaycastScratch scratch;
  ThreadPool pool(1);
  std::size_t cut = 0;
  for (int round = 0; round < 60; ++round) {
    const int reach = 2 + static_cast<int>(random() % 90);
    const VoxelSet measured = voxel_set(random_triples(random, 60, reach));
    const Voxel sensor{static_cast<int>(random() % 21) - 10, static_cast<int>(random() % 21) - 10,
                       static_cast<int>(random() % 21) - 10};
    const double voxel_size_m = round % 2 == 0 ? 0.25 : 0.2;
    const double range_m = voxel_size_m * (1 + static_cast<int>(random() % 120));
    const Triples expected = walk_all(measured, sensor, voxel_size_m, range_m);
    cut += expected != walk_all(measured, sensor, voxel_size_m, 1e9);
    ASSERT_EQ(observed_by(measured, sensor, voxel_size_m, range_m, scratch, pool), expected)
        << "round " << round;
  }
  EXPECT_GT(cut, 10U);
}

TEST(Raycast, EqualsTheErrorTermWalkToEndPointsFarBeyondTheRange) {
  constexpr int kFar = (1 << 19) - 1;
  std::mt19937 random(22);
  std::vector<Voxel> ends{{kFar, kFar, kFar}, {-kFar, kFar, 1},     {kFar, 0, 0},
                          {0, -kFar, 0},      {1, 1, -kFar},        {kFar, kFar - 1, kFar / 2},
                          {-kFar, -1, kFar},  {kFar / 2, -kFar, 2}, {-kFar, -kFar, -kFar}};
  for (int i = 0; i < 300; ++i) {
    const auto coordinate = [&] {
      const int limit = 1 << (4 + random() % 16);
      return static_cast<int>(random() % static_cast<unsigned>(2 * limit - 1)) - limit + 1;
    };
    ends.push_back({coordinate(), coordinate(), coordinate()});
  }
  for (const double range_m : {0.5, 30.0, 150.0}) {
    for (const Voxel& end : ends) {
      Triples expected;
      walk({0, 0, 0}, triple(end), 0.5, range_m, expected);
      ASSERT_EQ(observed_by(wide_set({end}), {}, 0.5, range_m), expected)
          << end.x << ' ' << end.y << ' ' << end.z << " at " << range_m << " m";
    }
  }
}

TEST(Raycast, ReachesTheLongestRange) {
  const std::vector<Voxel> ends{{1500, 0, 0},     {-1499, 30, 7}, {3, 1499, -1499},
                                {700, -900, 950}, {0, 0, -1500},  {4000, 3999, -3998}};
  const VoxelSet measured = wide_set(ends);
  EXPECT_EQ(observed_by(measured, {}, 1.0, kMaxRangeVoxels),
            walk_all(measured, {}, 1.0, kMaxRangeVoxels));
}

TEST(Raycast, SeveralSensorsSeeWhatEachSeesAloneAndNothingBetweenTheirOrigins) {
  std::mt19937 random(24);
  ThreadPool one(1), three(3);
  RaycastScratch scratch;
  const Voxel left{-4, 0, 0}, right{4, 1, 1};  // 2 m apart
  for (int round = 0; round < 20; ++round) {
    const VoxelSet of_left = voxel_set(random_triples(random, 60, 30));
    const VoxelSet of_right = voxel_set(random_triples(random, 60, 50));
    const double range_m = 2.0 + round;
    Triples expected = walk_all(of_left, left, 0.25, range_m);
    expected.merge(walk_all(of_right, right, 0.25, range_m));
    const std::array sources{RaySource{of_left, left, 0.25, range_m},
                             RaySource{of_right, right, 0.25, range_m}};
    for (ThreadPool* pool : {&one, &three}) {
      const VoxelList observed = raycast(sources, scratch, *pool);
      ASSERT_EQ(triples(observed.blocks, observed.masks), expected) << "round " << round;
    }
    Triples from_one = walk_all(of_left, left, 0.25, range_m);
    from_one.merge(walk_all(of_right, left, 0.25, range_m));
    ASSERT_NE(from_one, expected);
  }
}

TEST(Raycast, ThreadsAndReusedMemoryChangeNothing) {
  std::mt19937 random(23);
  ThreadPool one(1), seven(7);
  RaycastScratch shared;
  for (int round = 0; round < 4; ++round) {
    const VoxelSet measured = voxel_set(random_triples(random, 6000, 60 - 14 * round));
    const Voxel sensor{round * 40, -3, 2};
    const Triples expected = walk_all(measured, sensor, 0.2, 12.0);
    RaycastScratch fresh;
    EXPECT_EQ(observed_by(measured, sensor, 0.2, 12.0, fresh, one), expected);
    EXPECT_EQ(observed_by(measured, sensor, 0.2, 12.0, shared, seven), expected);
    EXPECT_EQ(observed_by(measured, sensor, 0.2, 12.0, shared, one), expected);
  }
}

}  // namespace
}  // namespace mosbench
