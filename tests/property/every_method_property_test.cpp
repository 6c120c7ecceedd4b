#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "tests/small_world.hpp"

/// What must hold for every method of the table, on random sequences.
namespace mosbench {
namespace {

class EveryMethodOnSmallWorlds : public testing::TestWithParam<std::string> {
 protected:
  /// Limits every method has suit the small world; all else is as by default.
  std::unique_ptr<Method> make(const RunContext& context, double track_window_s = 0) const {
    const MethodKind* kind = find_method(GetParam());
    Settings settings = kind->defaults;
    settings.set("min_range_m", 0.3);
    settings.set("max_range_m", 4.0);
    if (settings.find("resolution_m") != nullptr) settings.set("resolution_m", 0.4);
    // Random rays need wider neighbourhoods than beams.
    if (settings.find("neighbour_angle_rad") != nullptr) settings.set("neighbour_angle_rad", 0.3);
    for (const char* name : {"reference_offset_scans", "window_scans"}) {
      if (settings.find(name) != nullptr) settings.set(name, 3);
    }
    if (track_window_s > 0) settings.set("track_window_s", track_window_s);
    return kind->make(settings, context);
  }
};

std::vector<SmallWorld> small_worlds() {
  std::vector<SmallWorld> worlds;
  for (unsigned seed = 70; seed < 73; ++seed) {
    worlds.push_back(small_world({.seed = seed, .scans = 14, .defects = seed == 72}));
  }
  return worlds;
}

TEST_P(EveryMethodOnSmallWorlds, GivesTheSameLabelsScoresAndReasonsForAnyNumberOfThreads) {
  for (const SmallWorld& world : small_worlds()) {
    const auto expected = results_of(*make({.scores = true}), world);
    ASSERT_EQ(expected.size(), world.scans.size());
    for (const unsigned threads : {2U, 5U}) {
      const auto results = results_of(*make({.threads = threads, .scores = true}), world);
      ASSERT_EQ(results.size(), expected.size());
      for (std::size_t k = 0; k < results.size(); ++k) {
        ASSERT_EQ(results[k].labels, expected[k].labels) << "scan " << k;
        ASSERT_EQ(results[k].scores, expected[k].scores) << "scan " << k;
        ASSERT_EQ(results[k].reasons, expected[k].reasons) << "scan " << k;
      }
    }
  }
}

TEST_P(EveryMethodOnSmallWorlds, GivesARigWithEqualOriginsTheBitsOfOneCloudOrRefusesIt) {
  const MethodKind* kind = find_method(GetParam());
  for (const SmallWorld& world : small_worlds()) {
    SmallWorld rig = world;
    for (const std::vector<Point>& scan : rig.scans) {
      RayOrigins& origins = rig.origins.emplace_back();
      origins.positions_m.assign(2, Eigen::Vector3d::Zero());
      for (std::size_t i = 0; i < scan.size(); ++i) origins.of_point.push_back(i / 7 % 2);
    }
    if (!kind->takes_origins) {
      EXPECT_THROW(results_of(*make({}), rig), std::invalid_argument);
      continue;
    }
    const bool has_tracks = kind->defaults.find("track_window_s") != nullptr;
    for (const double window_s : {0.0, has_tracks ? 1.0 : 0.0}) {
      const auto expected = results_of(*make({.scores = true}, window_s), world);
      const auto results = results_of(*make({.threads = 3, .scores = true}, window_s), rig);
      ASSERT_EQ(results.size(), expected.size());
      for (std::size_t k = 0; k < results.size(); ++k) {
        ASSERT_EQ(results[k].labels, expected[k].labels) << "scan " << k;
        ASSERT_EQ(results[k].scores, expected[k].scores) << "scan " << k;
      }
    }
  }
}

/// Sensors at x = -1 and 1 m look along y at walls 5 m away. From the seventh scan on the right one
/// also sees a board 2.5 m away, around x = board_m.
SmallWorld world_of_two_columns(float board_m) {
  SmallWorld world;
  for (std::size_t k = 0; k < 12; ++k) {
    world.poses.push_back(Pose::Identity());
    std::vector<Point>& points = world.scans.emplace_back();
    RayOrigins& origins = world.origins.emplace_back();
    origins.positions_m = {{-1, 0, 0}, {1, 0, 0}};
    const auto add = [&](std::uint8_t sensor, float x, float y, float z) {
      points.push_back({x, y, z, 0});
      origins.of_point.push_back(sensor);
    };
    for (float u = -0.95F; u < 1; u += 0.1F) {
      for (float v = -0.95F; v < 1; v += 0.1F) {
        add(0, -1 + u, 5, v);
        add(1, 1 + u, 5, v);
        if (k > 6 && std::abs(u) < 0.3F && std::abs(v) < 0.3F) add(1, board_m + u, 2.5F, v);
      }
    }
  }
  return world;
}

/// The number of points of the board that move in some scan.
std::size_t moving_on_board(Method& method, const SmallWorld& world) {
  std::size_t moving = 0;
  for (const LabelledScan& scan : results_of(method, world)) {
    for (std::size_t i = 0; i < scan.labels.size(); ++i) {
      const bool is_board = world.scans[scan.scan_index][i].y < 4;
      moving += is_board && scan.labels[i] == kMovingLabel ? 1U : 0U;
    }
  }
  return moving;
}

TEST_P(EveryMethodOnSmallWorlds, KnowsWhatIsFreeBetweenTwoOriginsTwoMetresApart) {
  const MethodKind* kind = find_method(GetParam());
  if (!kind->takes_origins) GTEST_SKIP() << "refuses several origins, as tested above";
  const auto make_here = [&] {
    Settings settings = kind->defaults;
    settings.set("max_range_m", 12.0);
    for (const char* size : {"voxel_size_m", "resolution_m"}) {
      if (settings.find(size) != nullptr) settings.set(size, 0.2);
    }
    for (const char* none : {"pose_error_voxels", "min_otsu_score"}) {
      if (settings.find(none) != nullptr) settings.set(none, 0);
    }
    if (settings.find("kernel_width_voxels") != nullptr) settings.set("kernel_width_voxels", 3);
    if (settings.find("when") != nullptr)
      settings.set("when", kind->name == "dufomap" ? "online" : "before");
    return kind->make(settings, {});
  };
  // Where the right sensor's rays passed; a ray from the left one to its wall did not.
  SmallWorld ahead = world_of_two_columns(1);
  EXPECT_GT(moving_on_board(*make_here(), ahead), 20U);
  // Where no ray passed; one from the left sensor to the right one's wall would have.
  SmallWorld between = world_of_two_columns(0);
  EXPECT_EQ(moving_on_board(*make_here(), between), 0U);
  between.origins.assign(12, {{{-1, 0, 0}}, {}});
  for (std::size_t k = 0; k < 12; ++k)
    between.origins[k].of_point.assign(between.scans[k].size(), 0);
  EXPECT_GT(moving_on_board(*make_here(), between), 20U) << "this test cannot fail";
}

TEST_P(EveryMethodOnSmallWorlds, GivesTheSameLabelsWithAndWithoutScores) {
  for (const SmallWorld& world : small_worlds()) {
    const auto plain = results_of(*make({}), world);
    const auto scored = results_of(*make({.scores = true}), world);
    for (std::size_t k = 0; k < plain.size(); ++k) ASSERT_EQ(plain[k].labels, scored[k].labels);
  }
}

TEST_P(EveryMethodOnSmallWorlds, GivesAReasonToWhatMovesAloneAndOnlyWhereItSaysSo) {
  const bool gives_reasons = find_method(GetParam())->gives_reasons;
  for (const SmallWorld& world : small_worlds()) {
    for (const LabelledScan& scan : results_of(*make({}), world)) ASSERT_TRUE(scan.reasons.empty());
    for (const LabelledScan& scan : results_of(*make({.scores = true}), world)) {
      ASSERT_EQ(scan.reasons.size(), gives_reasons ? scan.labels.size() : 0U);
      for (std::size_t i = 0; i < scan.reasons.size(); ++i) {
        ASSERT_LT(static_cast<std::size_t>(scan.reasons[i]), kReasonCount);
        ASSERT_EQ(scan.reasons[i] != Reason::kNone, scan.labels[i] == kMovingLabel);
      }
    }
  }
}

TEST_P(EveryMethodOnSmallWorlds, NeverLabelsPointsMovingThatAreTooNearOrNotFinite) {
  std::size_t left_out = 0;
  for (const SmallWorld& world : small_worlds()) {
    const auto results = results_of(*make({}), world);
    for (std::size_t k = 0; k < results.size(); ++k) {
      for (std::size_t i = 0; i < world.scans[k].size(); ++i) {
        const Point& p = world.scans[k][i];
        if (std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) > 0.3F) continue;
        ++left_out;
        ASSERT_EQ(results[k].labels[i], kStaticLabel) << "scan " << k << " point " << i;
      }
    }
  }
  EXPECT_GT(left_out, 0U);
}

TEST_P(EveryMethodOnSmallWorlds, KeepsItsMemoryBoundedWhileItTravels) {
  const auto method = make({});
  if (!method->memory()) GTEST_SKIP() << "does not measure its memory";
  const SmallWorld world = small_world({.seed = 75, .scans = 20});
  std::size_t early_bytes = 0;
  for (std::size_t k = 0; k < 160; ++k) {
    Pose pose = world.poses[k % 20];
    pose.translation().x() += 3.0 * static_cast<double>(k);
    method->push(world.scans[k % 20], pose);
    if (k == 60) early_bytes = method->memory()->bytes;
  }
  ASSERT_GT(early_bytes, 1000U);
  EXPECT_LT(method->memory()->bytes, early_bytes + early_bytes / 2);
}

std::vector<std::string> method_names() {
  std::vector<std::string> known;
  for (const MethodKind& kind : methods()) {
    try {
      kind.check(kind.defaults);
      known.emplace_back(kind.name);
    } catch (const std::invalid_argument&) {
      // Its library is not in this build.
    }
  }
  return known;
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethodOnSmallWorlds, testing::ValuesIn(method_names()),
                         [](const auto& row) {
                           std::string name = row.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace mosbench
