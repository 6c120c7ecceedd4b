#include <gtest/gtest.h>

#include <random>

#include "core/odometry/point_grid.hpp"
#include "core/odometry/simple_cost.hpp"

/// Fast parts of odometry against ones that compare all pairs.
namespace mosbench::odometry {
namespace {

/// Points on surfaces and in clusters, some of them twice.
std::vector<Eigen::Vector3d> random_cloud(unsigned seed, std::size_t count, double extent_m) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d p(extent_m * uniform(), extent_m * uniform(),
                            i % 2 == 0 ? 0.1 * uniform() : 0.3 * extent_m * uniform());
    points.push_back(i % 50 == 7 ? points[i / 2] : p);
  }
  return points;
}

std::vector<Eigen::Vector3d> brute_thinned(const std::vector<Eigen::Vector3d>& points,
                                           double radius_m) {
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& p : points) {
    const bool free = std::ranges::none_of(kept, [&](const Eigen::Vector3d& other) {
      return (p - other).squaredNorm() < radius_m * radius_m;
    });
    if (free) kept.push_back(p);
  }
  return kept;
}

TEST(OdometryDifferential, ThinningEqualsComparingAllPairs) {
  for (const double radius_m : {0.1, 0.5, 2.0, 7.0}) {
    const auto points = random_cloud(3, 3000, 12);
    const auto expected = brute_thinned(points, radius_m);
    ASSERT_GT(expected.size(), 10u);
    ASSERT_LT(expected.size(), points.size());
    EXPECT_EQ(thinned(points, radius_m), expected);
  }
}

TEST(OdometryDifferential, TheGridsNearestPointIsTheNearestOfAll) {
  for (const double extent_m : {3.0, 30.0, 300.0}) {
    for (const double reach_m : {0.5, 3.0, 1000.0}) {
      const auto points = random_cloud(5, 600, extent_m);
      const Eigen::Vector3d offset(1e5, -3e5, 20);  // far from the origin
      PointGrid grid(1.0);
      for (const Eigen::Vector3d& p : points) grid.insert(p + offset);
      for (const Eigen::Vector3d& q : random_cloud(6, 400, 1.5 * extent_m)) {
        double best = 1e300, second = 1e300;
        for (const Eigen::Vector3d& p : points) {
          const double distance_m = (p + offset - (q + offset)).norm();
          second = std::min(second, std::max(best, distance_m));
          best = std::min(best, distance_m);
        }
        const Neighbour neighbour = grid.nearest(q + offset, reach_m);
        if (best <= reach_m || std::isfinite(neighbour.distance_m)) {
          EXPECT_EQ(neighbour.distance_m, best);
          EXPECT_LE(neighbour.others_m, second);
        } else {
          EXPECT_GT(best, reach_m);
          EXPECT_LE(neighbour.others_m, best);
          EXPECT_GE(neighbour.others_m, reach_m);
        }
      }
    }
  }
}

TEST(OdometryDifferential, RememberedNeighboursAreTheNearestAlongAnyPath) {
  const auto points = random_cloud(8, 500, 10);
  const auto scan = random_cloud(9, 200, 12);
  PointGrid grid(2.0);
  for (const Eigen::Vector3d& p : points) grid.insert(p);
  constexpr double kReach_m = 3.0;
  Correspondences correspondences(scan.size(), grid, kReach_m);
  std::mt19937 random(10);
  std::normal_distribution<double> normal;
  std::size_t found = 0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (int step = 0; step < 60; ++step) {
    const double length_m = step % 7 == 0 ? 1.0 : step % 3 == 0 ? 0.1 : 0.01;
    shift += length_m * Eigen::Vector3d(normal(random), normal(random), normal(random));
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const Eigen::Vector3d q = scan[i] + shift;
      double best = 1e300;
      for (const Eigen::Vector3d& p : points) best = std::min(best, (p - q).norm());
      const double distance_m = (correspondences.nearest(i, q) - q).norm();
      if (best > kReach_m) {
        EXPECT_GT(distance_m, kReach_m);
      } else {
        EXPECT_EQ(distance_m, best);
        ++found;
      }
    }
  }
  EXPECT_GT(found, 3000u);
}

/// The cost from all pairs.
double brute_cost(const std::vector<Eigen::Vector3d>& scan, const std::vector<Eigen::Vector3d>& map,
                  double sigma_m, const Vector6d& at) {
  double cost = 0;
  for (const Eigen::Vector3d& p : scan) {
    double best = 1e300;
    for (const Eigen::Vector3d& m : map) {
      best = std::min(best, (pose_of(at) * p - m).squaredNorm());
    }
    cost -= std::exp(-best / (2 * sigma_m * sigma_m));
  }
  return cost;
}

TEST(OdometryDifferential, CostsEqualThatOfAllPairsAndGradientsEachOther) {
  const auto map = thinned(random_cloud(11, 2000, 15), 1.0);
  const auto scan = random_cloud(12, 1500, 15);
  PointGrid grid(1.0);
  for (const Eigen::Vector3d& p : map) grid.insert(p);
  ThreadPool pool(2);
  std::mt19937 random(13);
  std::normal_distribution<double> normal;
  for (const double sigma_m : {0.3, 12.0}) {
    const SimpleProblem problem{scan, grid, sigma_m, 10 * sigma_m};
    NumericCost numeric(problem, pool);
    AnalyticCost analytic(problem, pool);
    for (int i = 0; i < 10; ++i) {
      Vector6d at, direction;
      for (int j = 0; j < 6; ++j) at[j] = (j < 3 ? 0.1 : 1.0) * normal(random);
      for (int j = 0; j < 6; ++j) direction[j] = 0.1 * normal(random);
      const double expected = brute_cost(scan, map, sigma_m, at);
      EXPECT_NEAR(numeric.value(at), expected, 1e-9 * std::abs(expected));
      EXPECT_NEAR(analytic.value(at), expected, 1e-9 * std::abs(expected));
      // A central difference of 1e-7 sees a change of nearest neighbour in few of 1,500 points.
      const Vector6d gradient = analytic.gradient(at);
      EXPECT_LT((numeric.gradient(at) - gradient).norm(), 2e-4 * gradient.norm() + 1e-4);
      EXPECT_NEAR(numeric.slope(at, direction, 0.5), analytic.slope(at, direction, 0.5),
                  2e-4 * gradient.norm() + 1e-4);
    }
  }
}

}  // namespace
}  // namespace mosbench::odometry
