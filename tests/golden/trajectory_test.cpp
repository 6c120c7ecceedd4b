#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "eval/trajectory/trajectory_scores.hpp"
#include "tests/parity_cases.hpp"

namespace mosbench {
namespace {

struct PublishedError {
  const char *mode, *sequence, *translation_percent, *rotation_deg_per_100_m;
};

/// What SiMpLE's authors print for the trajectories that they publish.
constexpr PublishedError kPublished[] = {{"online", "04", "0.406705", "0.163427"},
                                         {"offline", "04", "0.396662", "0.104197"},
                                         {"online", "07", "0.470648", "0.444404"},
                                         {"offline", "07", "0.299288", "0.182178"}};

TEST(KittiErrors, AreThePublishedOnesToEveryDigit) {
  const auto parity = parity::shared_parity_folder();
  if (!parity) GTEST_SKIP() << parity::kSkipMessage;
  const std::filesystem::path folder = parity->parent_path() / "odometry";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no folder odometry beside parity";
  for (const PublishedError& published : kPublished) {
    const std::string sequence = published.sequence;
    const std::vector<TrajectoryPair> pairs = read_trajectory_pairs(
        folder / ("simple_" + std::string(published.mode) + "_" + sequence + ".txt"),
        folder / ("truth_" + sequence + ".txt"), {});
    const TrajectoryPair& pair = pairs.front();
    const auto mean = mean_of(segment_errors(pair.truth, pair.estimate, kitti_segments()));
    ASSERT_TRUE(mean);
    EXPECT_EQ(fmt::format("{:.6g}", 100 * mean->translation), published.translation_percent);
    EXPECT_EQ(fmt::format("{:.6g}", mean->rotation_rad_per_m * 180 / std::numbers::pi * 100),
              published.rotation_deg_per_100_m);
  }
}

}  // namespace
}  // namespace mosbench
