#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <mosbench/method.hpp>
#include <ostream>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/stage_clock.hpp"
#include "tests/examples/new_voxels.hpp"

/// What Method promises, of every method in the table and of the example.
namespace mosbench {

/// What a test of one prints.
void PrintTo(const MethodKind& kind, std::ostream* out) { *out << kind.name; }

namespace {

const std::vector<Point> kWall = {{4, 0, 0, 0}, {4, 1, 0, 0}, {4, 2, 0, 0}, {4, -1, 1, 0}};

class EveryMethod : public testing::TestWithParam<MethodKind> {
 protected:
  std::unique_ptr<Method> make(const RunContext& context = {}) const {
    return GetParam().make(GetParam().defaults, context);
  }
};

TEST_P(EveryMethod, RefusesZeroThreads) {
  EXPECT_THROW(make({.threads = 0}), std::invalid_argument);
}

TEST_P(EveryMethod, LabelsEveryPointOfEveryScanOnceAndInOrder) {
  for (const bool scores : {false, true}) {
    const auto method = make({.scan_count = 8, .scores = scores});
    std::vector<LabelledScan> finals;
    for (std::size_t k = 0; k < 8; ++k) {
      const auto count = static_cast<std::ptrdiff_t>(k % (kWall.size() + 1));
      const std::vector<Point> points(kWall.begin(), kWall.begin() + count);
      for (LabelledScan& scan : method->push(points, Pose::Identity())) {
        finals.push_back(std::move(scan));
      }
    }
    for (LabelledScan& scan : method->finish()) finals.push_back(std::move(scan));
    ASSERT_EQ(finals.size(), 8U);
    for (std::size_t k = 0; k < finals.size(); ++k) {
      EXPECT_EQ(finals[k].scan_index, k);
      EXPECT_EQ(finals[k].labels.size(), k % (kWall.size() + 1));
      EXPECT_EQ(finals[k].scores.size(), scores ? finals[k].labels.size() : 0U);
      for (const std::uint32_t label : finals[k].labels) {
        EXPECT_TRUE(label == kStaticLabel || label == kMovingLabel) << label;
      }
    }
  }
}

TEST_P(EveryMethod, LeavesAStandingWallStatic) {
  const auto method = make({.scan_count = 30});
  std::vector<LabelledScan> finals;
  const auto take = [&](std::vector<LabelledScan> scans) {
    for (LabelledScan& scan : scans) finals.push_back(std::move(scan));
  };
  for (int k = 0; k < 30; ++k) take(method->push(kWall, Pose::Identity()));
  take(method->finish());
  ASSERT_EQ(finals.size(), 30U);
  const std::vector<std::uint32_t> all_static(kWall.size(), kStaticLabel);
  for (const LabelledScan& scan : finals) EXPECT_EQ(scan.labels, all_static) << scan.scan_index;
}

TEST_P(EveryMethod, LeavesOutAndCountsWhatIsNotFinite) {
  const auto method = make();
  std::vector<Point> points = kWall;
  points.push_back({std::nanf(""), 0, 0, 0});
  points.push_back({0, std::numeric_limits<float>::infinity(), 0, 0});
  std::vector<LabelledScan> finals = method->push(points, Pose::Identity());
  if (finals.empty()) finals = method->finish();
  ASSERT_EQ(finals.size(), 1U);
  EXPECT_EQ(finals.front().nonfinite_points, 2U);
  ASSERT_EQ(finals.front().labels.size(), points.size());
  EXPECT_EQ(finals.front().labels.back(), kStaticLabel);
}

TEST_P(EveryMethod, RefusesWhatIsOutOfReachAndPosesThatAreNotRigid) {
  const auto method = make();
  std::vector<Point> points = kWall;
  points.push_back({1e30F, 0, 0, 0});
  EXPECT_THROW(method->observe(points, Pose::Identity()), std::range_error);
  Pose scaled = Pose::Identity();
  scaled.linear() *= 3.0;
  EXPECT_THROW(method->observe(kWall, scaled), std::range_error);
  Pose undefined = Pose::Identity();
  undefined.translation().y() = std::nan("");
  EXPECT_THROW(method->push(kWall, undefined), std::range_error);
  EXPECT_NO_THROW(method->push(kWall, Pose::Identity()));
}

TEST_P(EveryMethod, RefusesOriginsThatDoNotFitThePoints) {
  const auto method = make();
  const Eigen::Vector3d place(1, 0, 0);
  const double nan = std::nan("");
  for (const RayOrigins& wrong :
       {RayOrigins{{place}, {0, 0, 0}}, RayOrigins{{place}, {}}, RayOrigins{{place}, {0, 0, 0, 1}},
        RayOrigins{{}, {0, 0, 0, 0}}, RayOrigins{{{nan, 0, 0}}, {0, 0, 0, 0}}}) {
    EXPECT_THROW(method->push(kWall, Pose::Identity(), wrong), std::invalid_argument);
  }
}

TEST_P(EveryMethod, RefusesScansBeyondTheirCountAndAfterTheEnd) {
  const auto counted = make({.scan_count = 1});
  counted->push(kWall, Pose::Identity());
  EXPECT_THROW(counted->push(kWall, Pose::Identity()), std::logic_error);
  const auto ended = make();
  ended->push(kWall, Pose::Identity());
  ended->finish();
  EXPECT_THROW(ended->push(kWall, Pose::Identity()), std::logic_error);
}

TEST_P(EveryMethod, RefusesScansThatAnotherObservedAndThoseOutOfOrder) {
  const auto one = make();
  const auto other = make();
  one->push(kWall, Pose::Identity());
  other->push(kWall, Pose::Identity());
  EXPECT_THROW(one->push(other->observe(kWall, Pose::Identity())), std::logic_error);
  EXPECT_THROW(one->push(nullptr), std::logic_error);
  auto earlier = one->observe(kWall, Pose::Identity());
  auto later = one->observe(kWall, Pose::Identity());
  EXPECT_NO_THROW(one->push(std::move(later)));
  EXPECT_THROW(one->push(std::move(earlier)), std::logic_error);
}

/// A list by hand, and what stands there before and after the name of a method.
struct HandList {
  const char *file, *before, *after;
};

TEST_P(EveryMethod, StandsWhereMethodsAreListedByHand) {
  if (GetParam().is_twin || find_method(GetParam().name) == nullptr) {
    GTEST_SKIP() << "no method of a benchmark";
  }
  const std::string name(GetParam().name);
  for (const auto& [file, before, after] :
       {HandList{"docs/methods/methods.md", "| `", "` |"},
        HandList{"results/studies/cost.yaml", "method: ", ","}}) {
    std::ifstream stream(std::filesystem::path(MOSBENCH_SOURCE_DIR) / file);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    EXPECT_TRUE(text.find(before + name + after) != std::string::npos)
        << file << ": has no method " << name
        << ", expected a row as docs/methods/methods.md says under \"Adding a method\"";
  }
}

/// `mosbench profile` and reports show where the time goes: a stage that ends behind the scan that
/// it belongs to is lost.
TEST_P(EveryMethod, TimesItsStages) {
  if (GetParam().is_twin) GTEST_SKIP() << "is there to be compared with";
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place_m(-6.0F, 6.0F);
  std::vector<Point> points(2000);
  for (Point& point : points) point = {place_m(random), place_m(random), place_m(random) / 8, 0};
  const auto method = make({.cpu_times = true});
  std::set<std::string_view> stages;
  const auto add = [&](const std::vector<LabelledScan>& scans) {
    for (const LabelledScan& scan : scans) {
      for (const StageTime& stage : scan.stages) stages.insert(stage.name);
    }
  };
  for (int k = 0; k < 24; ++k) {
    add(method->push(points, Pose(Eigen::Translation3d(0.5 * k, 0, 0))));
  }
  add(method->finish());
  EXPECT_FALSE(stages.contains(""));
  EXPECT_GE(stages.size(), 2U) << "what is done with the map, and what labels points";
}

TEST_P(EveryMethod, HasTheSettingsThatPresetsKnow) {
  for (const char* name : {"min_range_m", "max_range_m"}) {
    ASSERT_NE(GetParam().defaults.find(name), nullptr) << name;
    EXPECT_NO_THROW(GetParam().defaults.number(name));
  }
}

std::vector<MethodKind> kinds() {
  std::vector<MethodKind> known = {new_voxels::method_kind()};
  for (const MethodKind& kind : methods()) {
    try {
      kind.check(kind.defaults);
      known.push_back(kind);
    } catch (const std::invalid_argument& error) {
      // A library may be missing, and nothing else.
      EXPECT_THAT(error.what(), testing::HasSubstr("this build has no"));
    }
  }
  return known;
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, testing::ValuesIn(kinds()), [](const auto& row) {
  std::string name(row.param.name);
  std::erase(name, '-');
  return name;
});

}  // namespace
}  // namespace mosbench
