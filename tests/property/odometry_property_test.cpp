#include <gtest/gtest.h>

#include <random>

#include "core/odometry/point_grid.hpp"
#include "core/odometry/simple_cost.hpp"
#include "tests/odometry_scenes.hpp"
#include "tests/random_scans.hpp"

namespace mosbench {
namespace {

using Kind = std::pair<const char*, std::vector<std::pair<std::string_view, SettingValue>>>;
class AnyOdometry : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, AnyOdometry,
                         testing::Values(Kind{"simple", {}},
                                         Kind{"simple", {{"gradient", std::string("numeric")}}},
                                         Kind{"kiss", {}}));

TEST_P(AnyOdometry, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto& [name, settings] = GetParam();
  std::vector<std::vector<Pose>> poses;
  for (const unsigned threads : {1U, 2U, 5U}) {
    const auto odometry = make_odometry(name, settings, threads);
    std::vector<Pose>& found = poses.emplace_back();
    for (int k = 0; k < 6; ++k) {
      found.push_back(odometry->push(scene_points(street(), pose_at({0.4 * k, 0, 0}, 0.02 * k), k))
                          .map_from_sensor);
    }
  }
  EXPECT_GT(poses[0].back().translation().x(), 1.0);
  for (std::size_t k = 0; k < poses[0].size(); ++k) {
    EXPECT_EQ(poses[0][k].matrix(), poses[1][k].matrix());
    EXPECT_EQ(poses[0][k].matrix(), poses[2][k].matrix());
  }
}

TEST_P(AnyOdometry, StaysFiniteWhateverIsPushed) {
  const auto& [name, settings] = GetParam();
  std::size_t doubtful = 0;
  for (unsigned seed = 0; seed < 12; ++seed) {
    std::mt19937 random(seed);
    const auto odometry = make_odometry(name, settings);
    for (int k = 0; k < 8; ++k) {
      std::vector<Point> points;
      const std::size_t count = random() % 4 == 0 ? random() % 3 : random() % 1500;
      const float scale = random() % 3 == 0 ? 0.0F : random() % 5 == 0 ? 1e30F : 1.0F;
      for (std::size_t i = 0; i < count; ++i) {
        Point p = random_point(random);
        p.x *= scale;
        points.push_back(p);
      }
      std::vector<std::int64_t> times_ns(random() % 2 == 0 ? points.size() : 0U);
      for (std::int64_t& time_ns : times_ns) {
        time_ns = static_cast<std::int64_t>(random()) * (random() % 9 == 0 ? 1'000'000'000 : 1);
      }
      const auto stamp_ns = static_cast<std::int64_t>((std::uint64_t{random()} << 32) | random());
      const ScanPose pose = odometry->push(points, {stamp_ns, times_ns});
      ASSERT_TRUE(is_finite(pose)) << seed << ' ' << k;
      ASSERT_LT((pose.map_from_sensor.linear().transpose() * pose.map_from_sensor.linear() -
                 Eigen::Matrix3d::Identity())
                    .norm(),
                1e-9);
      if (pose.doubtful()) ++doubtful;
    }
  }
  EXPECT_GT(doubtful, 20u);
}

TEST(SimpleRegistration, RecoversASmallMotionOfARandomCloud) {
  using namespace odometry;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 * 2 - 1; };
    std::vector<Eigen::Vector3d> cloud;
    for (int i = 0; i < 3000; ++i)
      cloud.emplace_back(10 * uniform(), 10 * uniform(), 10 * uniform());
    cloud = thinned(cloud, 1.0);
    ASSERT_GT(cloud.size(), 500u);
    Angles6 truth;
    for (int i = 0; i < 6; ++i) truth[i] = (i < 3 ? 0.005 : 0.15) * uniform();
    std::vector<Eigen::Vector3d> scan;
    for (const Eigen::Vector3d& p : cloud) scan.push_back(pose_of(truth).inverse() * p);
    PointGrid map(1.0);
    for (const Eigen::Vector3d& p : cloud) map.insert(p);
    ThreadPool pool(1);
    const SimpleProblem problem{scan, map, 0.3, 3.0};
    NumericCost numeric(problem, pool);
    AnalyticCost analytic(problem, pool);
    for (Objective* cost : std::initializer_list<Objective*>{&numeric, &analytic}) {
      const Minimum found = minimise(*cost, Vector6d::Zero(), 1e-9);
      EXPECT_LT((found.at - truth).head<3>().norm(), 1e-5);
      EXPECT_LT((found.at - truth).tail<3>().norm(), 1e-4);
    }
  }
}

}  // namespace
}  // namespace mosbench
