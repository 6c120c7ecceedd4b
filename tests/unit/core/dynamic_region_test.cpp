#include "core/methods/hmm_mos/dynamic_region.hpp"

#include <gtest/gtest.h>

#include <map>

#include "core/methods/hmm_mos/otsu.hpp"
#include "tests/unit/core/otsu_of.hpp"
#include "tests/voxel_twins.hpp"

namespace mosbench {
using namespace hmm_mos;
namespace {

constexpr double kVoxelSize_m = 0.25;

struct Detection {
  Triples occupied, dynamic, from_region, beside_unknown;
  Eigen::Vector3d sensor_m = Eigen::Vector3d::Zero();
  double threshold = 5.0;
};

Detection detection(const Triples& occupied, const Triples& dynamic) {
  Detection result;
  result.occupied = occupied;
  result.dynamic = dynamic;
  return result;
}

/// The dynamic region of the authors' program, with a record for every voxel ever visited.
class RegionTwin {
 public:
  RegionTwin(double max_range_m, int w_d, int otsu_min)
      : max_range_m_(max_range_m), w_d_(w_d), otsu_min_(otsu_min) {}

  Triples back_end(const Detection& scan, int radius) const {
    std::map<Triple, int> votes;
    std::vector<int> positive;
    for (const Triple& v : scan.occupied) {
      if (scan.beside_unknown.contains(v)) continue;
      int count = 0;
      for_cube(v, radius, [&](const Triple& u) {
        const auto found = records_.find(u);
        count += found != records_.end() && found->second.high_confidence;
      });
      votes[v] = count;
      if (count > 0) positive.push_back(count);
    }
    Triples chosen;
    if (const std::optional<double> threshold = otsu_of(positive)) {
      for (const auto& [v, count] : votes) {
        if (count > *threshold) chosen.insert(v);
      }
    }
    return chosen;
  }

  void update(const Detection& scan, int k) {
    for (auto& [v, record] : records_) record.high_confidence = false;
    for (const Triple& v : scan.occupied) {
      Record& record = records_[v];
      if (record.last_seen == k) continue;
      if (scan.threshold > otsu_min_ && !record.dynamic) {
        record.dynamic = scan.dynamic.contains(v) && !scan.from_region.contains(v);
        record.last_seen = k;
      }
      record.beside_unknown = scan.beside_unknown.contains(v);
    }
    std::vector<int> scores;
    for (auto& [v, record] : records_) {
      if (!record.dynamic) continue;
      int score = 0;
      for_cube(v, 1, [&](const Triple& u) {
        const auto found = records_.find(u);
        score += found != records_.end() && found->second.dynamic;
      });
      record.score = score;
      scores.push_back(score);
    }
    threshold_ = otsu_of(scores).value_or(threshold_);
    for (auto& [v, record] : records_) {
      record.high_confidence =
          record.dynamic && !record.beside_unknown && record.score > threshold_;
    }
    std::erase_if(records_, [&](const auto& entry) {
      const Triple& v = entry.first;
      const Eigen::Vector3d offset_m =
          Eigen::Vector3d(v[0], v[1], v[2]) * kVoxelSize_m - scan.sensor_m;
      return offset_m.squaredNorm() > 4 * max_range_m_ * max_range_m_ ||
             (k > w_d_ && entry.second.last_seen < k - w_d_);
    });
  }

  std::set<Triple> dynamic_blocks() const {
    std::set<Triple> blocks;
    for (const auto& [v, record] : records_) {
      const BlockIndex block = block_of({v[0], v[1], v[2]});
      if (record.dynamic) blocks.insert({block.x, block.y, block.z});
    }
    return blocks;
  }

 private:
  struct Record {
    bool dynamic = false, high_confidence = false, beside_unknown = false;
    int score = 0, last_seen = 0;
  };
  double max_range_m_;
  int w_d_, otsu_min_;
  std::map<Triple, Record> records_;
  double threshold_ = 0;
};

/// The core's region next to its twin.
class Both {
 public:
  Both(double max_range_m, int w_d, int otsu_min)
      : core_({.voxel_size_m = kVoxelSize_m}, max_range_m, w_d, otsu_min),
        twin_(max_range_m, w_d, otsu_min) {}

  /// Returns the voxels that the region adds, asserted to be equal.
  Triples back_end(const Detection& detection, int kernel_width) {
    const Triples expected = twin_.back_end(detection, kernel_width / 2);
    EXPECT_EQ(triples(core_.back_end(scan_of(detection.occupied),
                                     voxel_set(detection.beside_unknown), kernel_width, pool_)),
              expected);
    return expected;
  }

  void update(const Detection& detection, std::uint32_t k) {
    VoxelizedScan scan = scan_of(detection.occupied);
    scan.sensor_m = detection.sensor_m;
    core_.update({scan, voxel_set(detection.dynamic), voxel_set(detection.from_region),
                  voxel_set(detection.beside_unknown), detection.threshold},
                 k);
    twin_.update(detection, static_cast<int>(k));
    std::set<Triple> blocks;
    for (const BlockIndex& block : core_.blocks_with({}))
      blocks.insert({block.x, block.y, block.z});
    EXPECT_EQ(blocks, twin_.dynamic_blocks()) << "scan " << k;
  }

 private:
  ThreadPool pool_{1};
  DynamicRegion core_;
  RegionTwin twin_;
};

Triples some_of(std::mt19937& random, const Triples& from, unsigned one_in) {
  Triples some;
  for (const Triple& v : from) {
    if (random() % one_in == 0) some.insert(v);
  }
  return some;
}

/// The occupied voxels of a scan never lie beyond its range.
Triples within_range(const Triples& voxels, const Eigen::Vector3d& sensor_m, double range_m) {
  Triples inside;
  for (const Triple& v : voxels) {
    if ((Eigen::Vector3d(v[0], v[1], v[2]) * kVoxelSize_m - sensor_m).norm() <= range_m) {
      inside.insert(v);
    }
  }
  return inside;
}

TEST(DynamicRegion, EqualsItsTwinOverRandomDetections) {
  std::size_t from_region = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    std::mt19937 random(seed);
    const int kernel_width = std::array{1, 3, 5, 7}[seed % 4];
    const double range_m = seed % 3 == 0 ? 0.9 : 3.0;
    Both regions(range_m, std::array{1, 4, 100}[seed / 4 % 3], 3);
    const Triples world = random_triples(random, 700, 6);
    for (std::uint32_t k = 4; k < 40; ++k) {
      for (int update = random() % 3 == 0 ? 2 : 1; update > 0; --update) {
        Detection detection;
        detection.sensor_m.x() = 0.3 * static_cast<double>(random() % 5);
        detection.occupied = within_range(some_of(random, world, 2), detection.sensor_m, range_m);
        detection.dynamic = some_of(random, detection.occupied, seed % 2 == 0 ? 4 : 15);
        detection.beside_unknown = some_of(random, detection.occupied, 5);
        detection.threshold = std::array{5.0, 3.1, 3.0, 0.0}[random() % 4];
        detection.from_region = regions.back_end(detection, kernel_width);
        from_region += detection.from_region.size();
        regions.update(detection, k);
        ASSERT_FALSE(HasFailure()) << "seed " << seed << " scan " << k;
      }
    }
  }
  EXPECT_GT(from_region, 1000U);
}

/// A voxel that the first of two detections at one time has found static stays so in the second.
TEST(DynamicRegion, SecondUpdateAtTheSameTimeLeavesStampedVoxelsAlone) {
  Both regions(3.0, 100, 3);
  regions.update(detection({{0, 0, 0}, {40, 0, 0}}, {{40, 0, 0}}), 7);
  regions.update(detection({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}}), 7);
  regions.update(detection({{0, 0, 0}}, {{0, 0, 0}}), 8);
}

TEST(DynamicRegion, VoxelsLeaveWhenTheyBecameDynamicMoreThanWdScansAgo) {
  DynamicRegion region({.voxel_size_m = kVoxelSize_m}, 10.0, 5, 3);
  const VoxelSet voxel = voxel_set({{1, 1, 1}}), none;
  const VoxelizedScan scan = scan_of({{1, 1, 1}});
  region.update({scan, voxel, none, none, 9.0}, 10);
  for (std::uint32_t k = 11; k <= 15; ++k) {
    region.update({scan, none, none, none, 9.0}, k);
    EXPECT_EQ(region.blocks_with({}).size(), 1U) << k;
  }
  region.update({scan, none, none, none, 9.0}, 16);
  EXPECT_TRUE(region.blocks_with({}).empty());
}

/// Voxels without neighbours around places that are apart: n of them around the n-th.
Triples crowds_of(int places) {
  Triples voxels;
  for (int place = 1; place <= places; ++place) {
    int left = place;
    for_cube({0, 0, 0}, 2, [&](const Triple& v) {
      if (left-- > 0) voxels.insert({16 * place + 2 * v[0], 2 * v[1], 2 * v[2]});
    });
  }
  return voxels;
}

// Votes from 1 to 101 have bins of one vote, so that the threshold in their middle is a vote.
TEST(DynamicRegion, AddsNoVoxelWithAsManyVotesAsTheThreshold) {
  constexpr int kPlaces = 101, kKernelWidth = 9;
  Both regions(1000.0, 100, 3);
  regions.update(detection(crowds_of(kPlaces), crowds_of(kPlaces)), 7);
  Triples middles;
  std::vector<int> votes;
  for (int place = 1; place <= kPlaces; ++place) {
    middles.insert({16 * place, 0, 0});
    votes.push_back(place);
  }
  ASSERT_EQ(otsu_of(votes), 51.0);
  EXPECT_EQ(regions.back_end(detection(middles, {}), kKernelWidth).size(), 50U);
}

TEST(DynamicRegion, NothingJoinsWhenTheThresholdIsNotAboveTheMinimum) {
  DynamicRegion region({.voxel_size_m = kVoxelSize_m}, 10.0, 5, 3);
  const VoxelSet voxel = voxel_set({{1, 1, 1}}), none;
  const VoxelizedScan scan = scan_of({{1, 1, 1}});
  region.update({scan, voxel, none, none, 3.0}, 10);
  EXPECT_TRUE(region.blocks_with({}).empty());
  region.update({scan, voxel, voxel, none, 9.0}, 11);
  EXPECT_TRUE(region.blocks_with({}).empty()) << "chosen by the region itself";
  region.update({scan, voxel, none, none, 3.01}, 12);
  EXPECT_EQ(region.blocks_with({}).size(), 1U);
}

}  // namespace
}  // namespace mosbench
