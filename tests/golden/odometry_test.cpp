#include <gtest/gtest.h>

#include <fstream>
#include <ostream>

#include "tests/odometry_scenes.hpp"
#include "tests/parity_cases.hpp"
#include "tests/sanitizers.hpp"

/// The poses of SiMpLE's own program on the four sequences of the parity cases.
namespace mosbench {
namespace {

struct Golden {
  const char* sequence;
  double min_range_m, max_range_m;
  double numeric_m, numeric_degrees;  ///< how far the poses may be from those of the authors
  double analytic_m, analytic_degrees;
};

void PrintTo(const Golden& golden, std::ostream* out) { *out << golden.sequence; }

// Registration of urban_vlp16 has two minima at scan 55, and rounding decides between them:
// compiled with fused multiply-add, the authors' program differs from itself by 49 mm there.
constexpr Golden kGoldens[] = {
    {"kitti_0005", 10, 80, 0.005, 0.02, 0.02, 0.1},
    {"sim_mall_os1", 0.5, 60, 0.005, 0.02, 0.02, 0.1},
    {"sim_campus_avia", 1, 80, 0.005, 0.02, 0.02, 0.1},
    {"sim_urban_vlp16", 10, 80, 0.1, 1.5, 0.2, 1.5},
};

std::vector<Pose> authors_poses(const std::string& sequence) {
  std::ifstream stream(*parity::shared_parity_folder() / "peers" / "simple" / (sequence + ".txt"));
  std::vector<Pose> poses;
  for (Pose pose = Pose::Identity();; poses.push_back(pose)) {
    for (int i = 0; i < 12; ++i) {
      if (!(stream >> pose.matrix()(i / 4, i % 4))) return poses;
    }
  }
}

class SimpleGolden : public testing::TestWithParam<Golden> {};
INSTANTIATE_TEST_SUITE_P(Sequences, SimpleGolden, testing::ValuesIn(kGoldens),
                         [](const auto& golden) { return std::string(golden.param.sequence); });

void expect_the_authors_poses(const Golden& golden, const std::string& gradient, double within_m,
                              double within_degrees) {
  const std::vector<Pose> expected = authors_poses(golden.sequence);
  ASSERT_GE(expected.size(), 50u);
  const auto odometry = make_odometry("simple", {{"gradient", gradient},
                                                 {"min_range_m", golden.min_range_m},
                                                 {"max_range_m", golden.max_range_m}});
  double worst_m = 0, worst_degrees = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const auto points =
        parity::read_records<Point>(*parity::parity_root() / "sequences" / golden.sequence /
                                    "velodyne" / (parity::stem(k) + ".bin"));
    const Pose pose = odometry->push(points).map_from_sensor;
    const Pose off = expected[k].inverse() * pose;
    worst_m = std::max(worst_m, off.translation().norm());
    worst_degrees = std::max(
        worst_degrees, Eigen::AngleAxisd(Eigen::Quaterniond(off.linear()).normalized()).angle() *
                           57.29577951308232);
    EXPECT_LT(worst_m, k == 1 && gradient == "numeric" ? 1e-5 : 1.0);
  }
  std::cout << golden.sequence << ' ' << gradient << ": at most " << worst_m * 1000 << " mm and "
            << worst_degrees << " degrees off the authors' poses\n";
  EXPECT_LT(worst_m, within_m);
  EXPECT_LT(worst_degrees, within_degrees);
}

TEST_P(SimpleGolden, NumericGradientGivesThePosesOfTheAuthorsProgram) {
  if (!parity::shared_parity_folder()) GTEST_SKIP() << parity::kSkipMessage;
  if (kSanitized) GTEST_SKIP() << "sanitized builds take minutes for these";
  expect_the_authors_poses(GetParam(), "numeric", GetParam().numeric_m, GetParam().numeric_degrees);
}

TEST_P(SimpleGolden, AnalyticGradientGivesNearlyTheSamePoses) {
  if (!parity::shared_parity_folder()) GTEST_SKIP() << parity::kSkipMessage;
  if (kSanitized) GTEST_SKIP() << "sanitized builds take minutes for these";
  expect_the_authors_poses(GetParam(), "analytic", GetParam().analytic_m,
                           GetParam().analytic_degrees);
}

}  // namespace
}  // namespace mosbench
