#include <gtest/gtest.h>

#include <cmath>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/pose_file.hpp"
#include "eval/trajectory/trajectory_scores.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

std::vector<Pose> path(std::initializer_list<Eigen::Vector3d> positions_m) {
  std::vector<Pose> poses;
  for (const Eigen::Vector3d& position_m : positions_m) {
    poses.push_back(Pose::Identity());
    poses.back().translation() = position_m;
  }
  return poses;
}

std::vector<Pose> straight(int count, double step_m) {
  std::vector<Pose> poses(static_cast<std::size_t>(count), Pose::Identity());
  for (int i = 0; i < count; ++i) poses[static_cast<std::size_t>(i)].translation().x() = i * step_m;
  return poses;
}

std::vector<Pose> moved_by(const Pose& move, std::vector<Pose> poses) {
  for (Pose& pose : poses) pose = move * pose;
  return poses;
}

Pose quarter_turn() {
  Pose turn = Pose::Identity();
  turn.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  turn.translation() = Eigen::Vector3d(3, 4, 0);
  return turn;
}

double rmse(const std::vector<double>& errors) { return summary_of(errors)->rmse; }

TEST(SegmentErrors, OfAnEstimateOnePercentTooLongAreOneMetreOfAHundred) {
  const auto errors = segment_errors(straight(151, 1.0), straight(151, 1.01), kitti_segments());
  ASSERT_EQ(errors.size(), 5u);
  EXPECT_EQ(errors[4].first, 40u);
  EXPECT_EQ(errors[4].last, 141u);
  EXPECT_NEAR(mean_of(errors)->translation, 0.0101, 1e-12);
  EXPECT_EQ(mean_of(errors)->rotation_rad_per_m, 0);
}

TEST(SegmentErrors, DoNotChangeWhenTheWholeEstimateIsMoved) {
  const auto errors = segment_errors(
      straight(151, 1.0), moved_by(quarter_turn(), straight(151, 1.01)), kitti_segments());
  EXPECT_NEAR(mean_of(errors)->translation, 0.0101, 1e-12);
}

TEST(SegmentErrors, OfAPathThatIsTooShortAreUndefined) {
  EXPECT_FALSE(mean_of(segment_errors(straight(91, 1.0), straight(91, 1.0), kitti_segments())));
  EXPECT_TRUE(mean_of(segment_errors(straight(91, 1.0), straight(91, 1.0), short_segments())));
}

TEST(PathAlignment, TakesAShiftOutOfAbsoluteErrors) {
  const auto truth = path({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {4, 2, 1}});
  Pose shift = Pose::Identity();
  shift.translation() = Eigen::Vector3d(3, 4, 0);
  const auto estimate = moved_by(shift, truth);
  EXPECT_NEAR(rmse(absolute_errors(truth, estimate).translation_m), 5, 1e-12);
  for (const PathAlignment way :
       {PathAlignment::kOrigin, PathAlignment::kRigid, PathAlignment::kSimilarity}) {
    const auto fitted = aligned(moved_by(quarter_turn(), truth), truth, way);
    EXPECT_NEAR(rmse(absolute_errors(truth, fitted->poses).translation_m), 0, 1e-9);
    EXPECT_NEAR(rmse(absolute_errors(truth, fitted->poses).rotation_rad), 0, 1e-9);
  }
}

TEST(PathAlignment, LeavesASymmetricSquareWhereItIs) {
  const auto truth = path({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}});
  const auto estimate = path({{1.4, 1.4, 0}, {-1, 1, 0}, {-1.4, -1.4, 0}, {1, -1, 0}});
  for (const PathAlignment way : {PathAlignment::kNone, PathAlignment::kRigid}) {
    const auto fitted = aligned(estimate, truth, way);
    EXPECT_NEAR(rmse(absolute_errors(truth, fitted->poses).translation_m), 0.4, 1e-12);
  }
}

TEST(PathAlignment, FindsTheScale) {
  const auto truth = path({{0, 0, 0}, {2, 0, 0}, {2, 4, 0}, {8, 4, 2}});
  auto estimate = truth;
  for (Pose& pose : estimate) pose.translation() /= 2;
  const auto fitted = aligned(estimate, truth, PathAlignment::kSimilarity);
  EXPECT_NEAR(fitted->scale, 2, 1e-12);
  EXPECT_NEAR(rmse(absolute_errors(truth, fitted->poses).translation_m), 0, 1e-9);
}

TEST(PathAlignment, OfAStraightLineIsUndefined) {
  const auto line = straight(10, 1.0);
  EXPECT_FALSE(aligned(line, line, PathAlignment::kRigid));
  EXPECT_TRUE(aligned(line, line, PathAlignment::kOrigin));
  EXPECT_THROW(score_of({"line", line, line, {}}, {PathAlignment::kRigid, {}}), DataError);
}

TEST(RelativeErrors, CompareMotionFromPoseToPose) {
  const auto truth = path({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  const auto estimate = path({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}});
  const PoseErrors errors = relative_errors(truth, estimate, {});
  EXPECT_EQ(errors.translation_m, (std::vector<double>{1, 1}));
  EXPECT_EQ(errors.rotation_rad, (std::vector<double>{0, 0}));
}

TEST(RelativeErrors, CountPairsByScansAndMetres) {
  const auto poses = straight(11, 1.0);
  const auto count = [&](const RelativePairs& pairs) {
    return relative_errors(poses, poses, pairs).translation_m.size();
  };
  EXPECT_EQ(count({.delta_m = {}, .delta_scans = 3}), 3u);
  EXPECT_EQ(count({.delta_m = {}, .delta_scans = 3, .all = true}), 8u);
  EXPECT_EQ(count({.delta_m = 3.0}), 2u);  // 3 to 6, 6 to 9
  EXPECT_EQ(count({.delta_m = 3.0, .all = true}), 8u);
  EXPECT_EQ(count({.delta_m = 3.4, .all = true}), 0u);  // 3 is 12 % off
  EXPECT_EQ(count({.delta_m = {}, .delta_scans = 11}), 0u);
}

TEST(ErrorSummary, IsThatOfThePopulation) {
  const auto summary = summary_of(std::vector<double>{4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(summary->mean, 2.5);
  EXPECT_DOUBLE_EQ(summary->median, 2.5);
  EXPECT_DOUBLE_EQ(summary->rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(summary->deviation, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(summary->squares, 30);
  EXPECT_EQ(summary->least, 1);
  EXPECT_EQ(summary->most, 4);
  EXPECT_FALSE(summary_of({}));
}

TEST(TrajectoryPairs, AreMatchedByStamps) {
  const TempFolder folder;
  write_file_atomic(folder / "a.tum",
                    "10.0 0 0 0 0 0 0 1\n10.1 1 0 0 0 0 0 1\n10.2 2 0 0 0 0 0 1\n");
  write_file_atomic(folder / "b.tum", "10.104 7 0 0 0 0 0 1\n10.3 9 0 0 0 0 0 1\n");
  const TrajectoryPair pair = read_trajectory_pair(folder / "a.tum", folder / "b.tum", {});
  ASSERT_EQ(pair.estimate.size(), 1u);
  EXPECT_EQ(pair.estimate[0].translation().x(), 1);
  EXPECT_EQ(pair.truth[0].translation().x(), 7);
  TrajectoryOptions strict;
  strict.max_time_difference_s = 0.001;
  EXPECT_THROW(read_trajectory_pair(folder / "a.tum", folder / "b.tum", strict), DataError);
}

TEST(TrajectoryPairs, OfUnlikeLengthAreRefused) {
  const TempFolder folder;
  write_poses(folder / "a.txt", straight(3, 1));
  write_poses(folder / "b.txt", straight(4, 1));
  EXPECT_THROW(read_trajectory_pair(folder / "a.txt", folder / "b.txt", {}), DataError);
}

TEST(TrajectoryPairs, AreTakenToTheCamera) {
  const TempFolder folder;
  Pose tr = quarter_turn();
  const auto lidar = straight(5, 1);
  std::vector<Pose> camera;
  for (const Pose& pose : lidar) camera.push_back(tr * pose * tr.inverse());
  write_poses(folder / "lidar.txt", lidar);
  write_poses(folder / "camera.txt", camera);
  TrajectoryOptions options;
  options.camera_from_lidar = tr;
  options.camera = CameraFrame::kTruth;
  const TrajectoryPair pair =
      read_trajectory_pair(folder / "lidar.txt", folder / "camera.txt", options);
  EXPECT_NEAR(rmse(absolute_errors(pair.truth, pair.estimate).translation_m), 0, 1e-12);
}

}  // namespace
}  // namespace mosbench
