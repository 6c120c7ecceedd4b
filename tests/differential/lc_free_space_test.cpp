#include <gtest/gtest.h>

#include "core/methods/lc_free_space/pipeline.hpp"
#include "tests/dynablox_twin.hpp"
#include "tests/small_world.hpp"

/// lc-free-space against maps of single voxels.
namespace mosbench {
namespace {

using dynablox_twin::Index;

/// Judges by the distances that the twin of Dynablox integrates.
class LcFreeSpaceTwin : dynablox_twin::DynabloxTwin {
 public:
  explicit LcFreeSpaceTwin(const lc_free_space::Config& config)
      : DynabloxTwin(with_same_map(config)), config_(config) {}

  dynablox_twin::TwinResult push(const std::vector<Point>& points, const Pose& pose) {
    const std::vector<Index> voxels = index(points, pose);
    const std::set<Index> measured(voxels.begin(), voxels.end());
    dynablox_twin::TwinResult result{std::vector<std::uint32_t>(points.size(), kStaticLabel), {}};
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Index& v = voxels[i];
      const auto found = map_.find(v);
      result.scores.push_back(found == map_.end() ? 0 : found->second.d);
      if (v != kNowhere && moves(v, measured)) result.labels[i] = kMovingLabel;
    }
    integrate(points, pose);
    return result;
  }

 private:
  static dynablox::Config with_same_map(const lc_free_space::Config& config) {
    dynablox::Config same;
    static_cast<tsdf::Config&>(same) = config;
    return same;
  }

  bool is_free(const Index& v) const {
    const auto found = map_.find(v);
    return found != map_.end() && found->second.w > 1e-6F &&
           found->second.d > config_.free_above_m();
  }

  bool moves(const Index& v, const std::set<Index>& measured) const {
    if (is_free(v)) return true;
    if (config_.level == lc_free_space::Level::kPoint) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const long step : {-1L, 1L}) {
        Index near = v;
        near[axis] += step;
        if (measured.contains(near) && is_free(near)) return true;
      }
    }
    return false;
  }

  lc_free_space::Config config_;
};

TEST(LcFreeSpaceTwin, GivesTheSameLabelsAndScores) {
  std::size_t moving = 0, by_neighbour = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    lc_free_space::Config config;
    config.voxel_size_m = 0.25;
    config.min_range_m = 0.3;
    config.max_range_m = 5.0;
    config.range_image_rows = 12;
    config.range_image_columns = 30;
    config.field_of_view_down_deg = -43;
    config.field_of_view_up_deg = 40;
    config.max_weight = seed < 5 ? 1000 : 20;
    config.free_above_voxels = std::array{0.0, 0.5, 1.0, 1.5, 1.9}[seed % 5];
    if (seed % 2 == 1) config.level = lc_free_space::Level::kPoint;
    const SmallWorld world =
        small_world({.seed = seed, .scans = 12, .noise_m = 0.02, .defects = seed > 6});
    LcFreeSpaceTwin twin(config);
    lc_free_space::Pipeline pipeline(config, {.threads = 1 + seed % 3, .scores = true});
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      const dynablox_twin::TwinResult expected = twin.push(world.scans[k], world.poses[k]);
      const LabelledScan result = std::move(pipeline.push(world.scans[k], world.poses[k]).front());
      ASSERT_EQ(result.labels, expected.labels) << "seed " << seed << ", scan " << k;
      ASSERT_EQ(result.scores, expected.scores) << "seed " << seed << ", scan " << k;
      for (std::size_t i = 0; i < result.labels.size(); ++i) {
        if (result.labels[i] != kMovingLabel) continue;
        ++moving;
        by_neighbour += result.scores[i] <= config.free_above_m();
      }
    }
  }
  EXPECT_GT(moving, 1000U);
  EXPECT_GT(by_neighbour, 100U);
}

}  // namespace
}  // namespace mosbench
