#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <numbers>

#include "core/methods/yoon/pipeline.hpp"
#include "core/methods/yoon/residual.hpp"
#include "core/voxel/directions.hpp"
#include "tests/small_world.hpp"

/// yoon against all pairs of points, step by step.
namespace mosbench {
namespace {

using YoonFlags = std::vector<bool>;

/// One scan against its reference.
struct YoonTwin {
  const yoon::Config& config;
  std::vector<Direction> own, queries, seen;  ///< the scan twice, and the reference
  std::vector<Eigen::Vector3f> points, reference;

  /// Neither free nor occupied: unknown.
  struct Finding {
    bool free = false, occupied = false;
  };

  Finding look(const Direction& query) const {
    const auto alpha = static_cast<float>(config.neighbour_angle_rad);
    const auto rho = static_cast<float>(config.free_margin_m);
    bool right = false, left = false, below = false, above = false;
    for (const Direction& n : seen) {
      if (n.range_m == 0 || query.range_m == 0) continue;
      const float b = bearing_difference_rad(query.bearing_rad, n.bearing_rad);
      const float e = n.elevation_rad - query.elevation_rad;
      if (b * b + e * e > alpha * alpha) continue;
      if (n.range_m - query.range_m < rho) return {false, true};
      right = right || b <= 0;
      left = left || b >= 0;
      below = below || e < 0;
      above = above || e > 0;
    }
    return {right && left && below && above, false};
  }

  float residual_m(const Eigen::Vector3f& point) const {
    std::vector<std::pair<float, std::size_t>> near;
    for (std::size_t i = 0; i < reference.size(); ++i) {
      const Eigen::Vector3f d = reference[i] - point;
      const float square = (d.x() * d.x() + d.y() * d.y()) + d.z() * d.z();
      if (seen[i].range_m > 0 && square < yoon::kFarthest_m * yoon::kFarthest_m) {
        near.emplace_back(square, i);
      }
    }
    std::ranges::sort(near);
    if (near.empty()) return yoon::kFarthest_m;
    const float to_point = std::sqrt(near[0].first);
    if (near.size() < 10) return to_point;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 10; ++i) mean += reference[near[i].second].cast<double>();
    mean /= 10;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < 10; ++i) {
      const Eigen::Vector3d d = reference[near[i].second].cast<double>() - mean;
      scatter += d * d.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
    if (!(axes.eigenvalues()[0] < config.planar_share * axes.eigenvalues().sum())) return to_point;
    const double to_plane = std::abs((point.cast<double>() - mean).dot(axes.eigenvectors().col(0)));
    return std::min(static_cast<float>(to_plane), yoon::kFarthest_m);
  }

  YoonFlags filtered(const YoonFlags& seeds) const {
    const int columns = static_cast<int>(2 * std::numbers::pi / config.neighbour_angle_rad);
    const auto column = [&](const Direction& d) {
      const double share = (d.bearing_rad + std::numbers::pi) / (2 * std::numbers::pi);
      return std::clamp(static_cast<int>(share * columns), 0, columns - 1);
    };
    const auto row = [&](const Direction& d) {
      return static_cast<int>((d.elevation_rad + std::numbers::pi / 2) /
                              config.neighbour_angle_rad);
    };
    YoonFlags kept(seeds.size());
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      int all = 0, moving = 0;
      for (std::size_t j = 0; seeds[i] && j < seeds.size(); ++j) {
        const int apart = std::abs(column(own[i]) - column(own[j]));
        const bool beside = std::min(apart, columns - apart) <= 1;
        if (own[j].range_m == 0 || !beside || std::abs(row(own[i]) - row(own[j])) > 1) continue;
        ++all;
        moving += seeds[j];
      }
      kept[i] = seeds[i] && 2 * moving >= all;
    }
    return kept;
  }

  YoonFlags grown(YoonFlags kept) const {
    YoonFlags grows = kept;
    const auto reach = static_cast<float>(config.growth_distance_m);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        if (kept[i] || queries[i].range_m == 0) continue;
        bool reached = false;
        for (std::size_t j = 0; j < kept.size() && !reached; ++j) {
          reached = grows[j] && (points[i] - points[j]).squaredNorm() <= reach * reach;
        }
        if (!reached || residual_m(points[i]) <= static_cast<float>(config.growth_residual_m)) {
          continue;
        }
        const Finding finding = look(queries[i]);
        kept[i] = true;
        grows[i] = finding.free || finding.occupied;
        changed = true;
      }
    }
    return kept;
  }

  YoonFlags moving() const {
    YoonFlags flags(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      flags[i] = look(queries[i]).free &&
                 residual_m(points[i]) > static_cast<float>(config.seed_residual_m);
    }
    if (config.last_step != yoon::LastStep::kSeeds) flags = filtered(flags);
    return config.last_step == yoon::LastStep::kGrowth ? grown(flags) : flags;
  }
};

std::vector<Eigen::Vector3f> positions(const std::vector<Point>& scan, const Pose& pose) {
  const Eigen::Isometry3f single = pose.cast<float>();
  std::vector<Eigen::Vector3f> all;
  for (const Point& p : scan) all.push_back(single * Eigen::Vector3f(p.x, p.y, p.z));
  return all;
}

TEST(YoonAgainstAllPairs, AgreesAfterEveryStep) {
  std::size_t moving = 0, scans = 0;
  ThreadPool pool(1);
  for (unsigned seed = 0; seed < 9; ++seed) {
    yoon::Config config;
    config.last_step = static_cast<yoon::LastStep>(seed % 3);
    config.min_range_m = 0.3;
    config.max_range_m = seed % 2 == 0 ? 5.0 : 2.5;
    config.neighbour_angle_rad = 0.3;
    config.window_scans = 1 + static_cast<int>(seed % 4);
    config.growth_distance_m = 0.5;
    config.growth_residual_m = 0.1;
    const SmallWorld world = small_world(
        {.seed = seed, .scans = 9, .azimuths = 40, .elevations = 16, .defects = seed % 4 == 3});
    yoon::Pipeline pipeline(config, {.threads = 1 + seed % 3});
    const std::vector<LabelledScan> results = results_of(pipeline, world);
    const auto n = static_cast<std::size_t>(config.window_scans);
    const RangeWindow all{config.min_range_m, std::numeric_limits<double>::max()};
    for (std::size_t k = n; k < world.scans.size(); ++k) {
      const Pose relative = world.poses[k - n].inverse() * world.poses[k];
      const YoonTwin twin{
          config,
          directions_of(world.scans[k], Pose::Identity(), all, pool),
          directions_of(world.scans[k], relative, {config.min_range_m, config.max_range_m}, pool),
          directions_of(world.scans[k - n], Pose::Identity(), all, pool),
          positions(world.scans[k], relative),
          positions(world.scans[k - n], Pose::Identity())};
      const YoonFlags expected = twin.moving();
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(results[k].labels[i], expected[i] ? kMovingLabel : kStaticLabel)
            << "seed " << seed << " scan " << k << " point " << i;
        moving += expected[i];
      }
      ++scans;
    }
  }
  EXPECT_GT(scans, 50U);
  EXPECT_GT(moving, 300U);
}

}  // namespace
}  // namespace mosbench
