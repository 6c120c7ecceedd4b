#include "eval/trajectory/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
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
  const TrajectoryPair pair = read_trajectory_pairs(folder / "a.tum", folder / "b.tum", {}).front();
  ASSERT_EQ(pair.estimate.size(), 1u);
  EXPECT_EQ(pair.estimate[0].translation().x(), 1);
  EXPECT_EQ(pair.truth[0].translation().x(), 7);
  TrajectoryOptions strict;
  strict.max_time_difference_s = 0.001;
  EXPECT_THROW(read_trajectory_pairs(folder / "a.tum", folder / "b.tum", strict), DataError);
}

TEST(TrajectoryPairs, OfUnlikeLengthAreRefused) {
  const TempFolder folder;
  write_poses(folder / "a.txt", straight(3, 1));
  write_poses(folder / "b.txt", straight(4, 1));
  EXPECT_THROW(read_trajectory_pairs(folder / "a.txt", folder / "b.txt", {}), DataError);
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
      read_trajectory_pairs(folder / "lidar.txt", folder / "camera.txt", options).front();
  EXPECT_NEAR(rmse(absolute_errors(pair.truth, pair.estimate).translation_m), 0, 1e-12);
}

TEST(TrajectoryPairs, OfFoldersHaveTheSameName) {
  const TempFolder folder;
  write_poses(folder / "estimates/mall/1.txt", straight(3, 2));
  write_poses(folder / "estimates/08.txt", straight(4, 1));
  write_poses(folder / "truths/08.txt", straight(4, 1));
  write_poses(folder / "truths/mall/1.txt", straight(3, 1));
  write_poses(folder / "truths/unused.txt", straight(9, 1));
  const auto pairs = read_trajectory_pairs(folder / "estimates", folder / "truths", {});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].name, "08");
  EXPECT_EQ(pairs[1].name, "mall/1");
  EXPECT_EQ(pairs[1].estimate[2].translation().x(), 4);
  EXPECT_EQ(pairs[1].truth[2].translation().x(), 2);
  std::filesystem::remove(folder / "truths/08.txt");
  EXPECT_THROW(read_trajectory_pairs(folder / "estimates", folder / "truths", {}), DataError);
  write_file_atomic(folder / "none/notes.md", "none");
  EXPECT_THROW(read_trajectory_pairs(folder / "none", folder / "truths", {}), DataError);
}

TEST(TrajectoryPairs, TakeTheLidarsPosesOfADataSetAndThoseThatRunsFound) {
  const TempFolder folder;
  Pose tr = quarter_turn();
  const auto lidar = straight(3, 1);
  std::vector<Pose> camera;
  for (const Pose& pose : lidar) camera.push_back(tr * pose * tr.inverse());
  const auto scans = folder / "kitti/sequences/08";
  for (const char* stem : {"000000", "000001", "000002"}) {
    write_bin(scans / "velodyne" / (std::string(stem) + ".bin"), std::vector<Point>(5));
  }
  write_poses(scans / "poses.txt", camera);
  write_file_atomic(scans / "calib.txt", format_calib(tr));
  write_poses(folder / "runs/08/poses.txt", lidar);
  std::filesystem::copy(MOSBENCH_SOURCE_DIR "/tests/golden/old_results/odometry/08/result.json",
                        folder / "runs/08/result.json");
  for (const char* estimate : {"runs", "runs/08", "runs/08/poses.txt", "kitti"}) {
    for (const char* truth : {"kitti", "kitti/sequences/08"}) {
      const auto pairs = read_trajectory_pairs(folder / estimate, folder / truth, {});
      ASSERT_EQ(pairs.size(), 1u);
      EXPECT_NEAR(rmse(absolute_errors(pairs[0].truth, pairs[0].estimate).translation_m), 0, 1e-12);
    }
  }
  EXPECT_EQ(read_trajectory_pairs(folder / "runs", folder / "kitti", {})[0].name, "08");
  TrajectoryOptions options;
  options.camera_from_lidar = tr;
  options.camera = CameraFrame::kTruth;
  EXPECT_THROW(read_trajectory_pairs(folder / "runs", folder / "kitti", options), UsageError);
}

TEST(TrajectoryPairs, SayWhenTheOtherFrameFitsFarBetter) {
  Pose camera_from_lidar = Pose::Identity();
  camera_from_lidar.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  std::vector<Pose> lidar, camera;
  for (int k = 0; k < 20; ++k) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(0.02 * k, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.translation() = Eigen::Vector3d(k, 0.01 * k * k, 0);
    lidar.push_back(pose);
    camera.push_back(camera_from_lidar * pose * camera_from_lidar.inverse());
  }
  const auto remark = [](const auto& estimate, const auto& truth,
                         const TrajectoryOptions& options) {
    return frame_remark({"a", estimate, truth, {}}, options).value_or("none");
  };
  EXPECT_EQ(remark(lidar, lidar, {}), "none");
  EXPECT_EQ(remark(camera, camera, {}), "none");
  EXPECT_THAT(remark(lidar, camera, {}), testing::HasSubstr("--camera truth:CALIB"));
  EXPECT_THAT(remark(camera, lidar, {}), testing::HasSubstr("--camera estimate:CALIB"));
  // Said of files that are both the lidar's: the estimate was turned before.
  TrajectoryOptions turned;
  turned.camera = CameraFrame::kTruth;
  turned.camera_from_lidar = camera_from_lidar;
  EXPECT_THAT(remark(camera, lidar, turned), testing::HasSubstr("0.000 m without --camera"));
}

/// A straight drive whose every motion is off by a normal error.
std::vector<Pose> drive_with_noise(double sigma_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise_m(0, sigma_m);
  std::vector<Pose> poses = straight(1000, 1);
  Eigen::Vector3d off_m = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k < poses.size(); ++k) {
    off_m += Eigen::Vector3d(noise_m(random), noise_m(random), noise_m(random));
    poses[k].translation() += off_m;
  }
  return poses;
}

TEST(PathDifferences, HaveIntervalsThatHoldTheTruth) {
  const std::vector<Pose> truth = straight(1000, 1);
  const auto score = [&](const std::vector<Pose>& estimate) {
    return score_of({"s", estimate, truth, {}}, {});
  };
  const std::vector<TrajectoryScore> fine = {score(drive_with_noise(0.010, 1))},
                                     coarse = {score(drive_with_noise(0.012, 2))};
  const auto rows = compare_paths(fine, coarse), back = compare_paths(coarse, fine),
             same = compare_paths(fine, fine);
  ASSERT_EQ(rows[4].name, "relative_translation_m");
  const Difference& rpe = rows[4].difference;
  ASSERT_TRUE(rpe.interval) << rpe.no_interval;
  // Three axes.
  EXPECT_NEAR(*rows[4].first, 0.010 * std::sqrt(3), 0.0005);
  EXPECT_LT(rpe.interval->low, 0.002 * std::sqrt(3));
  EXPECT_GT(rpe.interval->high, 0.002 * std::sqrt(3));
  // Half of the relative error of a mean square of 3 x 999 normal numbers, of both.
  const double expected = 0.5 * std::sqrt(2.0 / 2997) * std::sqrt(3) * std::hypot(0.010, 0.012);
  EXPECT_NEAR(*rpe.standard_error, expected, 0.3 * expected);
  EXPECT_LT(*rpe.p_value, 0.001);
  EXPECT_NEAR(back[4].difference.interval->low, -rpe.interval->high, 1e-12);
  EXPECT_EQ(*same[4].difference.value, 0);
  EXPECT_EQ(*same[4].difference.p_value, 1);
  EXPECT_EQ(*same[4].difference.standard_error, 0);  // all they have in common cancels
  EXPECT_THAT(rows[6].difference.no_interval, testing::HasSubstr("one bad motion"));
}

TEST(PathDifferences, AreThoseOfThePooledMeans) {
  const auto scaled = [](double by) {
    std::vector<Pose> poses = straight(151, 1);
    for (Pose& pose : poses) pose.translation() *= by;
    return poses;
  };
  const std::vector<Pose> truth = straight(151, 1);
  const std::vector<TrajectoryPair> first = {{"s", scaled(1.01), truth, {}}},
                                    second = {{"s", scaled(1.03), truth, {}}},
                                    other = {{"s", truth, scaled(2), {}}};
  check_same_truth(first, second);
  EXPECT_THROW(check_same_truth(first, other), DataError);
  const std::vector<TrajectoryScore> a = {score_of(first[0], {})}, b = {score_of(second[0], {})};
  const auto rows = compare_paths(a, b);
  ASSERT_EQ(rows[0].name, "kitti_translation");
  // Five segments of 101 m, per 100 m.
  EXPECT_NEAR(*rows[0].first, 0.0101, 1e-9);
  EXPECT_NEAR(*rows[0].difference.value, 0.0202, 1e-9);
  EXPECT_FALSE(rows[0].difference.interval);
  EXPECT_THAT(rows[0].difference.no_interval, testing::HasSubstr("5 scans, expected at least"));
}

}  // namespace
}  // namespace mosbench
