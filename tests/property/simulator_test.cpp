#include "datasets/simulator/simulator.hpp"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <thread>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/trajectory.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

std::uint64_t hash_of(const SimulatedScan& scan) {
  return XXH3_64bits(scan.points.data(), scan.points.size() * sizeof(Point));
}

std::uint64_t hash_of(const Simulator& simulator, std::size_t scan_index) {
  return hash_of(simulator.scan(scan_index));
}

std::size_t count_moving(const Frame& frame) {
  return static_cast<std::size_t>(
      std::count(frame.truth->begin(), frame.truth->end(), kMovingLabel));
}

// Signed distance from a point of the map frame to the surface of a body: 0 on it, negative inside.
double signed_distance_m(const Solid& solid, const Eigen::Vector3d& map_m) {
  const Eigen::Vector3d offset = map_m - solid.center_m;
  const Eigen::Vector3d local(offset.x() * solid.axis.x() + offset.y() * solid.axis.y(),
                              offset.y() * solid.axis.x() - offset.x() * solid.axis.y(),
                              offset.z());
  const Eigen::Vector3d& half = solid.half_size_m;
  if (solid.shape == Shape::kSphere) return local.norm() - half.x();
  const double side = solid.shape == Shape::kBox
                          ? std::max(std::abs(local.x()) - half.x(), std::abs(local.y()) - half.y())
                          : local.head<2>().norm() - half.x();
  return std::max(side, std::abs(local.z()) - half.z());
}

bool inside_grown(const Solid& solid, const Eigen::Vector3d& map_m, double margin_m) {
  const Eigen::Vector3d offset = map_m - solid.center_m;
  return offset.norm() <= solid.half_size_m.norm() + margin_m;
}

TEST(Simulator, DependsNeitherOnTheOrderOfScansNorOnThreads) {
  const Simulator simulator = built_in_simulator("room", "vlp-16", 9);
  const std::uint64_t fifth = hash_of(simulator, 5), second = hash_of(simulator, 2);
  std::uint64_t fifth_elsewhere = 0, second_elsewhere = 0;
  {
    const std::jthread one([&] { second_elsewhere = hash_of(simulator, 2); });
    const std::jthread two([&] { fifth_elsewhere = hash_of(simulator, 5); });
  }
  EXPECT_EQ(fifth, fifth_elsewhere);
  EXPECT_EQ(second, second_elsewhere);
  EXPECT_NE(fifth, second);
  EXPECT_NE(fifth, hash_of(built_in_simulator("room", "vlp-16", 10), 5));
}

class EveryScene : public testing::TestWithParam<std::string_view> {};

INSTANTIATE_TEST_SUITE_P(BuiltIn, EveryScene,
                         testing::Values("mall", "campus", "street", "road", "highway", "room"),
                         [](const auto& name) { return std::string(name.param); });

TEST(BuiltInScenes, AreTheOnesTheseTestsCover) {
  std::vector<std::string_view> names;
  for (const SceneSummary& scene : built_in_scenes()) names.push_back(scene.name);
  EXPECT_EQ(names,
            (std::vector<std::string_view>{"mall", "campus", "street", "road", "highway", "room"}));
  EXPECT_THROW(built_in_scene("mal"), UsageError);
}

TEST_P(EveryScene, HoldsMovingPointsSoonAndLater) {
  const Simulator simulator = built_in_simulator(GetParam(), "os1-64", 1);
  for (const std::size_t scan_index : {5U, 10U, 20U, 60U, 400U}) {
    EXPECT_GT(count_moving(simulator.frame(scan_index)), 20U) << "scan " << scan_index;
  }
}

TEST_P(EveryScene, SeesMostlyStaticThingsAround) {
  const Frame frame = built_in_simulator(GetParam(), "os1-64", 1).frame(10);
  const auto fixed = std::count(frame.truth->begin(), frame.truth->end(), kStaticLabel);
  EXPECT_GT(fixed, std::ssize(*frame.truth) / 3);
}

TEST_P(EveryScene, PutsEveryPointOnTheSurfaceThatItClaims) {
  Scene scene = built_in_scene(GetParam());
  scene.beam_width_rad.reset();  // returns between two surfaces are on neither
  const Simulator simulator(scene, sensor_model(SensorKind::kHdl64e), 6);
  const double noise_m = simulator.sensor().range_noise_m * kNormalBound + 1e-4;
  for (const std::size_t scan_index : {0U, 37U}) {
    const SimulatedScan scan = simulator.scan(scan_index);
    std::size_t checked = 0;
    for (std::size_t i = 0; i < scan.points.size(); i += 7) {
      if (scan.owners[i] == SimulatedScan::kNoReturn || scan.owners[i] == 0) continue;
      const Point& p = scan.points[i];
      const Eigen::Vector3d map_m = scan.map_from_sensor * Eigen::Vector3d(p.x, p.y, p.z);
      double nearest_m = 1e9;
      for (const Solid& solid : scan.scene.solids) {
        if (solid.owner != scan.owners[i]) continue;
        const bool leaf = solid.density < 1.0 && inside_grown(solid, map_m, noise_m);
        nearest_m = leaf ? 0.0 : std::min(nearest_m, std::abs(signed_distance_m(solid, map_m)));
        if (leaf) break;
      }
      ASSERT_LE(nearest_m, noise_m) << "scan " << scan_index << " slot " << i;
      ++checked;
    }
    EXPECT_GT(checked, 1000U);
  }
}

TEST_P(EveryScene, SurvivesBeingWrittenAsJson) {
  const Scene scene = built_in_scene(GetParam());
  const Scene back = parse_scene(format_scene(scene), "scene.json");
  EXPECT_EQ(format_scene(back), format_scene(scene));
  const SensorModel sensor = sensor_model(SensorKind::kVlp16);
  for (const std::size_t scan_index : {0U, 123U}) {
    EXPECT_EQ(hash_of(Simulator(back, sensor, 3), scan_index),
              hash_of(Simulator(scene, sensor, 3), scan_index));
  }
}

TEST_P(EveryScene, KeepsTheCarrierOutOfStructuresAndAtAConstantPace) {
  const Scene scene = built_in_scene(GetParam());
  const Simulator simulator(scene, sensor_model(SensorKind::kVlp16), 1);
  SimulatedScan before = simulator.scan(0);
  for (std::size_t scan_index = 1; scan_index < 1500; scan_index += 1) {
    if (scan_index % 50 > 1) continue;
    const SimulatedScan scan = simulator.scan(scan_index);
    for (const Solid& solid : scan.scene.solids) {
      const double away_m = signed_distance_m(solid, scan.map_from_sensor.translation());
      ASSERT_GT(away_m, 0.2) << "scan " << scan_index << " owner " << solid.owner;
    }
    if (scan_index % 50 == 1) {
      const double step_m =
          (scan.map_from_sensor.translation() - before.map_from_sensor.translation()).norm();
      EXPECT_LT(step_m, 2.6) << "scan " << scan_index;
    }
    before = scan;
  }
}

/// A sensor without noise 1 m above the ground that looks along x at a wall from 10 m on.
Scene before_a_wall() {
  Scene scene;
  scene.name = "wall";
  scene.range_noise_m = 0.0;
  scene.dropout_probability = 0.0;
  scene.ego = {.carrier = Carrier::kTripod, .sensor_height_m = 1.0, .route = {}};
  scene.ground = {GroundPlane{}};
  scene.structures = {{.center_m = {10.5, 0.0, 5.0}, .size_m = {1.0, 20.0, 10.0}}};
  return scene;
}

/// The points of a scan in the map frame, above the sensor, 17 degrees off the x axis at most.
std::vector<Eigen::Vector3d> points_ahead(const Scene& scene, std::size_t scan_index = 0) {
  const SimulatedScan scan =
      Simulator(scene, sensor_model(SensorKind::kOs1_64), 3).scan(scan_index);
  std::vector<Eigen::Vector3d> points_m;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const Point& p = scan.points[i];
    const Eigen::Vector3d at = scan.map_from_sensor * Eigen::Vector3d(p.x, p.y, p.z);
    if (std::abs(at.y()) < 0.3 * at.x() && at.z() > 1) points_m.push_back(at);
  }
  return points_m;
}

std::size_t count_between(const std::vector<Eigen::Vector3d>& points_m, double low, double high) {
  return static_cast<std::size_t>(std::ranges::count_if(
      points_m, [&](const Eigen::Vector3d& p) { return p.x() > low && p.x() < high; }));
}

TEST(SimulatedGlass, LetsItsShareOfRaysThrough) {
  Scene scene = before_a_wall();
  scene.structures.push_back(
      {.center_m = {5.0, 0.0, 5.0}, .size_m = {0.02, 20.0, 10.0}, .let_through = 0.7});
  const auto points_m = points_ahead(scene);
  ASSERT_GT(points_m.size(), 1000U);
  const std::size_t behind = count_between(points_m, 9.9, 10.1);
  EXPECT_EQ(behind + count_between(points_m, 4.9, 5.1), points_m.size());
  EXPECT_NEAR(static_cast<double>(behind), 0.7 * static_cast<double>(points_m.size()),
              0.08 * static_cast<double>(points_m.size()));
}

TEST(SimulatedMirrors, ShowWhatStandsBeforeThemAsFarBehind) {
  Scene scene = before_a_wall();
  scene.structures = {{.center_m = {6.0, 0.0, 5.0}, .size_m = {2.0, 20.0, 10.0}, .mirrors = true},
                      {.center_m = {-2.5, 0.0, 5.0}, .size_m = {1.0, 40.0, 10.0}}};
  const auto points_m = points_ahead(scene);
  ASSERT_GT(points_m.size(), 500U);
  // The mirror is at 5 m, the wall's face at -2 m.
  EXPECT_EQ(count_between(points_m, 11.99, 12.01), points_m.size());
}

TEST(SimulatedBeams, ReturnRangesBetweenTwoThingsWhenTheyAreWide) {
  Scene scene = before_a_wall();
  scene.structures.push_back(
      {.shape = Shape::kCylinder, .center_m = {9.0, 0.0, 5.0}, .size_m = {0.2, 0.2, 10.0}});
  EXPECT_EQ(count_between(points_ahead(scene), 9.15, 9.95), 0U);
  scene.beam_width_rad = 0.003;
  EXPECT_GT(count_between(points_ahead(scene), 9.15, 9.95), 10U);
}

TEST(SimulatedLeaves, SwayAsFarAsTheyMay) {
  Scene scene = before_a_wall();
  const auto cells = [&](std::size_t scan_index) {
    std::set<std::array<int, 3>> found;  // of 0.2 m
    for (const Eigen::Vector3d& p : points_ahead(scene, scan_index)) {
      if (p.x() > 9) continue;
      found.insert({static_cast<int>(std::floor(p.x() * 5)),
                    static_cast<int>(std::floor(p.y() * 5)),
                    static_cast<int>(std::floor(p.z() * 5))});
    }
    return found;
  };
  const auto in_both = [&] {
    const auto first = cells(0), later = cells(5);
    const auto count =
        std::ranges::count_if(first, [&](const auto& c) { return later.contains(c); });
    return static_cast<double>(count) / static_cast<double>(first.size());
  };
  scene.structures.push_back(
      {.center_m = {5.0, 0.0, 2.0}, .size_m = {2.0, 4.0, 2.0}, .density = 0.2});
  const double still = in_both();
  scene.structures.back().sway_m = 0.3;
  EXPECT_GT(still, 0.8);
  EXPECT_LT(in_both(), still - 0.2);
}

TEST(SimulatedGround, RisesAndFallsByItsBumps) {
  Scene scene = before_a_wall();
  scene.structures.clear();
  scene.ground_bumps_m = 0.05;
  const SimulatedScan scan = Simulator(scene, sensor_model(SensorKind::kOs1_64), 3).scan(0);
  double lowest_m = 0, highest_m = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] == SimulatedScan::kNoReturn) continue;
    const Point& p = scan.points[i];
    const double z_m = (scan.map_from_sensor * Eigen::Vector3d(p.x, p.y, p.z)).z();
    lowest_m = std::min(lowest_m, z_m);
    highest_m = std::max(highest_m, z_m);
  }
  EXPECT_GT(lowest_m, -0.05001);
  EXPECT_LT(highest_m, 0.05001);
  EXPECT_GT(highest_m - lowest_m, 0.08);
}

TEST(Simulator, ReturnsExactRangesWithoutNoise) {
  Scene scene = built_in_scene("room");
  scene.range_noise_m = 0.0;
  scene.dropout_probability = 0.0;
  scene.ego.carrier = Carrier::kTripod;
  const Simulator simulator(scene, sensor_model(SensorKind::kOs1_64), 1);
  const SimulatedScan scan = simulator.scan(4);
  std::size_t on_ground = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (scan.owners[i] != 0) continue;
    ++on_ground;
    ASSERT_NEAR(scan.points[i].z, -0.8, 1e-6);
  }
  EXPECT_GT(on_ground, 1000U);
}

TEST(RoadScene, LetsPartOfTheRaysThroughTheWindowsOfParkedCars) {
  const Simulator simulator = built_in_simulator("road", "hdl-64e", 1);
  const auto& structures = simulator.scene().structures;
  std::size_t on_panes = 0, on_seats = 0;
  for (const std::uint32_t owner : simulator.scan(10).owners) {
    if (owner == 0 || owner > structures.size()) continue;
    const Structure& structure = structures[owner - 1];
    on_panes += structure.let_through ? 1U : 0U;
    on_seats += structure.size_m == std::array{0.15, 0.45, 0.5} ? 1U : 0U;
  }
  EXPECT_GT(on_panes, 50U);
  EXPECT_GT(on_seats, 10U);
}

TEST(RoadScene, HasNobodyWhoGoesThroughWhatStands) {
  const Scene scene = built_in_scene("road");
  constexpr double kClear_m = 0.15;
  for (int tenth = 0; tenth < 300; ++tenth) {
    for (const Mover& mover : scene.movers) {
      const Eigen::Vector2d at_m = route_state(mover.route, 0.1 * tenth).position_m;
      for (const Structure& structure : scene.structures) {
        const bool is_in_the_way =
            structure.center_m[2] - structure.size_m[2] / 2.0 < 1.5 && structure.size_m[2] > 0.15;
        const bool is_hit =
            std::abs(at_m.x() - structure.center_m[0]) < structure.size_m[0] / 2.0 + kClear_m &&
            std::abs(at_m.y() - structure.center_m[1]) < structure.size_m[1] / 2.0 + kClear_m;
        ASSERT_FALSE(is_in_the_way && is_hit) << at_m.transpose() << " at " << tenth;
      }
    }
  }
}

}  // namespace
}  // namespace mosbench
