#include <gtest/gtest.h>

#include <cmath>

#include "core/odometry/bfgs.hpp"
#include "core/odometry/engine.hpp"
#include "core/odometry/point_grid.hpp"
#include "core/odometry/pose_certainty.hpp"
#include "core/odometry/rigid_motion.hpp"
#include "core/odometry/scan_odometry.hpp"
#include "core/odometry/scan_points.hpp"
#include "core/odometry/simple_cost.hpp"

namespace mosbench::odometry {
namespace {

std::vector<Eigen::Vector3d> on_x_axis(std::initializer_list<double> xs) {
  std::vector<Eigen::Vector3d> points;
  for (const double x : xs) points.emplace_back(x, 0, 0);
  return points;
}

TEST(OdometryThinning, KeepsAPointWithoutKeptPointNearerThanTheRadius) {
  EXPECT_EQ(thinned(on_x_axis({0, 0.4, 0.6, 1.0, 1.4}), 0.5), on_x_axis({0, 0.6, 1.4}));
}

TEST(OdometryThinning, KeepsPointsExactlyTheRadiusApartAndDropsDuplicates) {
  EXPECT_EQ(thinned(on_x_axis({0, 0.5, 0.5, 0}), 0.5), on_x_axis({0, 0.5}));
}

TEST(OdometryThinning, InsertsIntoAMapWhatIsFarEnoughFromOldAndNewPoints) {
  PointGrid map(2.0);
  map.insert(Eigen::Vector3d::Zero());
  const std::vector<std::size_t> expected = {1};
  EXPECT_EQ(insert_apart(on_x_axis({1.9, 2.0, 3.9}), 2.0, map), expected);
  EXPECT_EQ(map.size(), 2u);
}

TEST(OdometryThinning, KeepsTheFirstPointOfEveryCell) {
  EXPECT_EQ(first_of_cells(on_x_axis({0.3, 0.1, -0.1, 1.0, 1.9, 0.9}), 1.0),
            on_x_axis({0.3, -0.1, 1.0}));
}

TEST(OdometryPointGrid, ForgetsPointsAtOrBeyondARadius) {
  PointGrid grid(1.0);
  for (const Eigen::Vector3d& p : on_x_axis({0, 4.9, 5, 5.1})) grid.insert(p);
  grid.keep_within(Eigen::Vector3d::Zero(), 5);
  EXPECT_EQ(grid.size(), 2u);
  PointGrid other(1.0);
  EXPECT_FALSE(std::isfinite(other.nearest({20, 0, 0}, 3).distance_m));
  EXPECT_DOUBLE_EQ(grid.nearest({7, 0, 0}, 3).distance_m, 7 - 4.9);
}

/// Returns how many of the corners of a cube inside one voxel of 1 m a KISS map keeps.
std::size_t kept_in_one_voxel(int max_points_per_voxel) {
  KissConfig config;
  config.max_points_per_voxel = max_points_per_voxel;
  ThreadPool pool(1);
  const auto engine = make_engine(config, pool);
  for (int corner = 0; corner < 8; ++corner) {
    const auto side_m = [&](int axis) { return (corner >> axis & 1) == 0 ? 0.1 : 0.9; };
    const std::vector<Eigen::Vector3d> points = {{side_m(0), side_m(1), side_m(2)}};
    engine->take(points);
    engine->enter(Pose::Identity());
  }
  return engine->map_points();
}

TEST(KissMap, HoldsAtMostItsPointsInAVoxel) {
  EXPECT_EQ(kept_in_one_voxel(20), 8U);
  EXPECT_EQ(kept_in_one_voxel(3), 3U);
}

std::vector<Eigen::Vector3d> lattice(std::size_t count) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i);
    points.emplace_back(std::fmod(n, 5.0), std::fmod(std::floor(n / 5), 5.0), std::floor(n / 25));
    points.back() = points.back() * 3.0 + Eigen::Vector3d::Constant(0.5);
  }
  return points;
}

/// Returns the overlap of 50 points of the map and one 1.2 m beside, after predictions that were
/// off by 0.2 m.
double kiss_overlap_after(int predictions) {
  std::vector<Eigen::Vector3d> points = lattice(50);
  ThreadPool pool(1);
  const auto engine = make_engine(KissConfig(), pool);
  engine->take(points);
  engine->enter(Pose::Identity());
  points.emplace_back(1.7, 0.5, 0.5);
  engine->take(points);
  const Pose off(Eigen::Translation3d(0.2, 0, 0));
  for (int i = 0; i < predictions; ++i) engine->learn(off);
  return engine->align(Pose::Identity()).overlap;
}

TEST(KissThreshold, FallsWithTheErrorsOfPredictionsAndLimitsCorrespondences) {
  EXPECT_DOUBLE_EQ(kiss_overlap_after(0), 1);            // 3 sigma = 6 m
  EXPECT_DOUBLE_EQ(kiss_overlap_after(100), 50 / 51.0);  // 3 sigma = 0.85 m
}

TEST(SimpleOverlap, IsTheShareOfPointsNearTheMap) {
  ThreadPool pool(1);
  const auto engine = make_engine(SimpleConfig(), pool);
  engine->take(lattice(50));
  engine->enter(Pose::Identity());
  engine->take(lattice(75));  // the last 25 lie 3 m above the map
  EXPECT_NEAR(engine->align(Pose::Identity()).overlap, 50 / 75.0, 1e-12);
}

struct CostCase {
  std::vector<Eigen::Vector3d> scan = on_x_axis({1});
  PointGrid map{2.0};
  ThreadPool pool{1};
  CostCase() { map.insert({1.3, 0, 0}); }
  SimpleProblem problem() const { return {scan, map, 0.3, 3.0}; }
};

template <typename Cost>
void expect_worked_values(double tolerance) {
  CostCase a;
  Cost cost(a.problem(), a.pool);
  EXPECT_NEAR(cost.value(Vector6d::Zero()), -0.606531, 1e-6);
  const Vector6d gradient = cost.gradient(Vector6d::Zero());
  EXPECT_NEAR(gradient[3], -2.021769, tolerance);
  EXPECT_NEAR(gradient[2], 0, tolerance);
  EXPECT_NEAR(gradient[5], 0, tolerance);
  const Vector6d along_x = Vector6d::Unit(3);
  EXPECT_NEAR(cost.slope(Vector6d::Zero(), along_x, 0.0), -2.021769, tolerance);
}

TEST(SimpleCost, HasTheValuesWorkedByHandWithNumericGradient) {
  expect_worked_values<NumericCost>(2e-6);
}

TEST(SimpleCost, HasTheValuesWorkedByHandWithAnalyticGradient) {
  expect_worked_values<AnalyticCost>(1e-6);
}

TEST(SimpleCost, IsZeroWhereTheMapIsOutOfReach) {
  CostCase a;
  AnalyticCost cost(a.problem(), a.pool);
  Vector6d away = Vector6d::Zero();
  away[4] = 50;
  EXPECT_EQ(cost.value(away), 0);
  EXPECT_EQ(cost.gradient(away), Vector6d::Zero());
}

/// f(x) = sum of (x_i - i)^2 (i + 1).
class Bowl : public Objective {
 public:
  double value(const Vector6d& at) override {
    double sum = 0;
    for (int i = 0; i < 6; ++i) sum += (at[i] - i) * (at[i] - i) * (i + 1);
    return sum;
  }
  Vector6d gradient(const Vector6d& at) override {
    Vector6d gradient;
    for (int i = 0; i < 6; ++i) gradient[i] = 2 * (at[i] - i) * (i + 1);
    return gradient;
  }
  double slope(const Vector6d& at, const Vector6d& direction, double step) override {
    return gradient(at + step * direction).dot(direction);
  }
};

TEST(Bfgs, FindsTheBottomOfABowl) {
  Bowl bowl;
  const Minimum minimum = minimise(bowl, Vector6d::Constant(7), 1e-12);
  EXPECT_TRUE(minimum.settled);
  EXPECT_NEAR(minimum.value, 0, 1e-9);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(minimum.at[i], i, 1e-4);
  EXPECT_LT(minimum.steps, 30);
}

TEST(Bfgs, StaysWhereTheFunctionIsFlat) {
  CostCase a;
  AnalyticCost cost(a.problem(), a.pool);
  Vector6d away = Vector6d::Zero();
  away[4] = 50;
  const Minimum minimum = minimise(cost, away, 1e-3);
  EXPECT_EQ(minimum.at, away);
  EXPECT_TRUE(minimum.settled);
}

TEST(RigidMotion, PredictsConstantVelocity) {
  Pose one = Pose::Identity(), two = Pose::Identity();
  one.translation().x() = 1;
  two.translation().x() = 2;
  EXPECT_EQ(predicted(one, two).translation(), Eigen::Vector3d(3, 0, 0));
}

TEST(RigidMotion, TurnsAnglesIntoAPoseAndBack) {
  Angles6 angles;
  angles << 0.3, -0.7, 2.9, 4, 5, 6;
  EXPECT_TRUE(angles_of(pose_of(angles)).isApprox(angles, 1e-14));
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(2.9, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_TRUE(rotation_of(angles).isApprox(expected, 1e-14));
}

TEST(RigidMotion, GivesNoNaNWhereRoundingPassesAQuarterTurn) {
  Pose steep = Pose::Identity();
  steep.linear() << 0, 0, 1, 0, 1, 0, -1.0000000000000002, 0, 0;
  EXPECT_TRUE(angles_of(steep).allFinite());
}

TEST(ScanPoints, KeepsWhatIsStrictlyBetweenTheRanges) {
  ScanConfig config;
  config.min_range_m = 1;
  config.max_range_m = 5;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Point> points = {
      {1, 0, 0, 0}, {0, 1.5F, 0, 0}, {3, 4, 0, 0}, {nan, 2, 0, 0}, {0, 0, 4, 0}};
  const ScanPoints kept = points_in_range(points, config);
  EXPECT_EQ(kept.rows, (std::vector<std::size_t>{1, 4}));
}

TEST(ScanPoints, AreRaisedByTheCorrectionOfKitti) {
  const Eigen::Vector3d p = raised({10, 0, -1});
  EXPECT_NEAR(p.norm(), std::sqrt(101.0), 1e-12);
  EXPECT_NEAR(std::atan2(p.z(), p.x()) - std::atan2(-1.0, 10.0), 0.205 * M_PI / 180, 1e-12);
  EXPECT_EQ(p.y(), 0);
  EXPECT_EQ(raised({0, 0, 3}), Eigen::Vector3d(0, 0, 3));
}

TEST(Deskew, MovesAPointByItsShareOfTheMotion) {
  const ScanPoints scan{on_x_axis({5, 5, 5}), {0, 1, 2}};
  Pose motion = Pose::Identity();
  motion.translation() = Eigen::Vector3d(0, 1, 0);
  const std::vector<std::int64_t> times_ns = {0, 50, -100};
  const auto points_m = deskewed(scan, times_ns, motion, 100);
  EXPECT_EQ(points_m[0], Eigen::Vector3d(5, 0, 0));
  EXPECT_EQ(points_m[1], Eigen::Vector3d(5, 0.5, 0));
  EXPECT_EQ(points_m[2], Eigen::Vector3d(5, -1, 0));
}

TEST(ScanClock, FindsGapsAndStampsThatDoNotRise) {
  ScanClock clock(0.1);
  EXPECT_EQ(clock.tick(1'000'000'000).doubt, "");
  EXPECT_EQ(clock.tick(1'200'000'000).period_ns, 200'000'000);
  EXPECT_EQ(clock.tick(1'400'000'000).periods, 1);
  EXPECT_NE(clock.tick(1'400'000'000).doubt, "");
  EXPECT_NE(clock.tick(1'300'000'000).doubt, "");
  const ScanClock::Interval gap = clock.tick(3'400'000'000);
  EXPECT_DOUBLE_EQ(gap.periods, 10);
  EXPECT_NE(gap.doubt, "");
  EXPECT_EQ(clock.tick(3'600'000'000).doubt, "");
}

std::vector<Eigen::Vector3d> floor_points() {
  std::vector<Eigen::Vector3d> floor;
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y) floor.emplace_back(0.5 * x, 0.5 * y, -1.5);
  }
  return floor;
}

TEST(PoseCertainty, OfAFloorSaysNothingOfShiftsAlongItAndTurnsAboutItsNormal) {
  const std::vector<SurfaceSample> samples = surface_samples(floor_points(), 0.5);
  ASSERT_GT(samples.size(), 300u);
  for (const SurfaceSample& sample : samples) {
    EXPECT_NEAR(sample.hold(2, 2), 1, 0.05);
    EXPECT_LT(sample.hold(0, 0) + sample.hold(1, 1), 0.02);
  }
  // The floor lies 0.1 m above the map's here and 0.1 m below there.
  std::vector<std::optional<Eigen::Vector3d>> offsets_m;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    offsets_m.emplace_back(Eigen::Vector3d(0, 0, i % 2 == 0 ? 0.1 : -0.1));
  }
  const Certainty certainty = certainty_of(samples, offsets_m);
  EXPECT_LT(certainty.weakest, 0.01);
  EXPECT_LT(std::abs(certainty.weakest_shift.z()), 0.01);
  EXPECT_TRUE(certainty.covariance.allFinite());
  const auto points = static_cast<double>(samples.size());
  EXPECT_NEAR(certainty.covariance(5, 5), (0.1 * 0.1 + 0.02 * 0.02) / points, 0.1 * 0.01 / points);
  EXPECT_GT(certainty.covariance(3, 3), 100 * certainty.covariance(5, 5));
}

TEST(PoseCertainty, CountsTheMotionThatSurfacesAskFor) {
  const std::vector<SurfaceSample> samples = surface_samples(floor_points(), 0.5);
  const auto spread_m = [&](double above_m) {
    const std::vector<std::optional<Eigen::Vector3d>> offsets_m(samples.size(),
                                                                Eigen::Vector3d(0.4, 0.3, above_m));
    return std::sqrt(certainty_of(samples, offsets_m).covariance(5, 5));
  };
  // Along the floor an offset says nothing; a surface 0.4 m off is another, so that nothing is
  // known.
  EXPECT_LT(spread_m(0), 0.01);
  EXPECT_NEAR(spread_m(0.2), 0.2, 0.01);
  EXPECT_GT(spread_m(0.4), 10);
}

TEST(SurfaceSamples, AreNotTakenOfALineOfPoints) {
  std::vector<Eigen::Vector3d> line;
  for (int x = -20; x <= 20; ++x) line.emplace_back(0.5 * x, 3, 0);
  EXPECT_TRUE(surface_samples(line, 0.5).empty());
  EXPECT_TRUE(surface_samples({}, 0.5).empty());
  EXPECT_TRUE(certainty_of({}, {}).covariance.allFinite());
}

}  // namespace
}  // namespace mosbench::odometry
