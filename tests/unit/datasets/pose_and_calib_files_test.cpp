#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/disk/files.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kIdentityNumbers = "1 0 0 0 0 1 0 0 0 0 1 0";

Pose turned(double angle_rad, const Eigen::Vector3d& axis, const Eigen::Vector3d& position_m) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix();
  pose.translation() = position_m;
  return pose;
}

std::string pose_error(const std::string& text) {
  return message_of<DataError>([&] { parse_poses(text, "poses.txt"); });
}

TEST(PoseFile, KeepsEveryNumberAsTheNearestDouble) {
  const auto poses = parse_poses(
      "1 0 0 0.1 0 1 0 512.3494872970000123 0 0 1 -0\n"
      "9.998847842216492e-01 -0.01474427804350853 0.0036163609474897385 512.3494873046875 "
      "0.014742804691195488 0.9998912215232849 0.00043360600830055773 512.0064086914062 "
      "-0.0036223609931766987 -0.00038024099194444716 0.9999933838844299 64.00347900390625\r\n",
      "poses.txt");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].translation().x(), 0.1);
  EXPECT_EQ(poses[0].translation().y(), 512.3494872970000123);
  EXPECT_EQ(poses[1].linear()(0, 1), -0.01474427804350853);
  EXPECT_EQ(poses[1].linear()(2, 2), 0.9999933838844299);
  EXPECT_EQ(poses[1].translation().z(), 64.00347900390625);
}

TEST(PoseFile, WritesNumbersThatReadBackBitForBit) {
  std::vector<Pose> poses;
  for (int i = 0; i < 200; ++i) {
    poses.push_back(turned(0.037 * i, {0.3, -1.0 / 7, 1.0}, {i / 3.0, -1e-17 * i, 1e7 / (i + 1)}));
  }
  const auto again = parse_poses(format_poses(poses), "poses.txt");
  ASSERT_EQ(again.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(again[i].matrix(), poses[i].matrix()) << "row " << i;
  }
}

TEST(PoseFile, AcceptsRotationsRoundedToSixDigits) {
  EXPECT_EQ(parse_poses("0.999885 -0.0147443 0.00361636 0 0.0147428 0.999891 0.000433606 0 "
                        "-0.00362236 -0.000380241 0.999993 0\n",
                        "poses.txt")
                .size(),
            1U);
}

TEST(PoseFile, AllowsBlankLinesOnlyAtTheEnd) {
  EXPECT_EQ(parse_poses(std::string(kIdentityNumbers) + "\n\n \n", "poses.txt").size(), 1U);
  EXPECT_EQ(parse_poses("", "poses.txt").size(), 0U);
  EXPECT_THAT(pose_error(std::string(kIdentityNumbers) + "\n\n" + kIdentityNumbers + "\n"),
              HasSubstr("poses.txt:2: blank line"));
}

TEST(PoseFile, NamesTheLineOfARowWithoutTwelveNumbers) {
  EXPECT_THAT(pose_error(std::string(kIdentityNumbers) + "\n1 0 0 0 0 1 0 0 0 0 1\n"),
              AllOf(HasSubstr("poses.txt:2: 11 numbers"), HasSubstr("expected 12")));
  EXPECT_THAT(pose_error(std::string(kIdentityNumbers) + " 1\n"),
              HasSubstr("poses.txt:1: 13 numbers"));
}

TEST(PoseFile, RefusesTextAndNumbersThatAreNotFinite) {
  for (const char* number : {"east", "nan", "-inf", "1e999", "0x1p3", "1,0", "1.0f"}) {
    EXPECT_THAT(pose_error(std::string("1 0 0 ") + number + " 0 1 0 0 0 0 1 0\n"),
                AllOf(HasSubstr("poses.txt:1: \"" + std::string(number) + "\""),
                      HasSubstr("no finite number")));
  }
}

TEST(PoseFile, RefusesWhatIsNoRotationAndSaysWhatItFound) {
  EXPECT_THAT(pose_error("2 0 0 0 0 1 0 0 0 0 1 0\n"),
              AllOf(HasSubstr("poses.txt:1: rotation is not orthonormal"), HasSubstr("by 3,")));
  EXPECT_THAT(pose_error("1 0.002 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("not orthonormal"));
  EXPECT_THAT(pose_error("-1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("mirrors"));
  EXPECT_THAT(pose_error("0 0 0 0 0 0 0 0 0 0 0 0\n"), HasSubstr("not orthonormal"));
  EXPECT_THAT(pose_error("1e300 1e300 -1e300 0 1e300 -1e300 1e300 0 1e300 1 1 0\n"),
              HasSubstr("not orthonormal"));
}

TEST(PoseFile, ReadsBackFromDisk) {
  const TempFolder folder;
  const std::vector<Pose> poses = {Pose::Identity(), turned(1.0, {0, 0, 1}, {1, 2, 3})};
  write_poses(folder / "poses.txt", poses);
  EXPECT_EQ(read_poses(folder / "poses.txt")[1].matrix(), poses[1].matrix());
}

TEST(CalibFile, TakesTrAndNothingElse) {
  const Pose tr = parse_calib(
      "P0: 7 0 6 0 0 7 1 0 0 0 1 0\nTr: 0 -1 0 0.1 0 0 -1 0.2 1 0 0 0.3\nTr_imu: x\n", "calib.txt");
  EXPECT_EQ(tr.linear()(0, 1), -1.0);
  EXPECT_EQ(tr.translation().z(), 0.3);
}

TEST(CalibFile, RefusesAMissingATwofoldAndAShortTr) {
  const auto error_of = [](const std::string& text) {
    return message_of<DataError>([&] { parse_calib(text, "calib.txt"); });
  };
  EXPECT_THAT(error_of("P0: 1 0 0 0 0 1 0 0 0 0 1 0\n"),
              AllOf(HasSubstr("calib.txt: has no line \"Tr:\""), HasSubstr("expected")));
  EXPECT_THAT(error_of(""), HasSubstr("has no line"));
  const std::string row = std::string("Tr: ") + kIdentityNumbers + "\n";
  EXPECT_THAT(error_of(row + row), HasSubstr("calib.txt:2: a second"));
  EXPECT_THAT(error_of("\nTr: 1 0 0 0 0 1 0 0 0 0 1\n"), HasSubstr("calib.txt:2: 11 numbers"));
  EXPECT_THAT(error_of("Tr: 7 0 0 0 0 7 0 0 0 0 7 0\n"), HasSubstr("calib.txt:1: rotation"));
}

TEST(CalibFile, ReadsBackFromDisk) {
  const TempFolder folder;
  const Pose tr = turned(0.4, {1, 1, 0}, {0.1, 0.2, 0.3});
  write_file_atomic(folder / "calib.txt", format_calib(tr));
  EXPECT_EQ(read_calib(folder / "calib.txt").matrix(), tr.matrix());
}

TEST(LidarPose, IsThePoseItselfWhenTrIsTheIdentity) {
  const Pose pose = turned(0.123456, {1, 2, 3}, {512.1, -3.3, 1e-9});
  EXPECT_EQ(lidar_pose(pose, Pose::Identity()).matrix(), pose.matrix());
}

TEST(LidarPose, FollowsTheKittiConvention) {
  // A camera looks along z with y down; the lidar's x is forward. The camera moves 5 m forward.
  const Pose camera_from_lidar =
      parse_calib("Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n", "calib.txt");
  const Pose camera_pose = parse_poses("1 0 0 0 0 1 0 0 0 0 1 5\n", "poses.txt")[0];
  const Pose lidar = lidar_pose(camera_pose, camera_from_lidar);
  EXPECT_LT((lidar.translation() - Eigen::Vector3d(5, 0, 0)).norm(), 1e-12);
  EXPECT_LT((lidar.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

TEST(LidarPose, TakesEveryPointToWhereTheChainOfTransformsTakesIt) {
  const Pose camera_from_lidar = turned(2.0, {1, -1, 0.5}, {0.1, -0.2, 0.3});
  const Pose pose = turned(-0.7, {0, 1, 0.2}, {10, 20, -3});
  const Eigen::Vector3d point_m(4, 5, 6);
  const Eigen::Vector3d by_hand =
      camera_from_lidar.inverse() * (pose * (camera_from_lidar * point_m));
  EXPECT_LT((lidar_pose(pose, camera_from_lidar) * point_m - by_hand).norm(), 1e-12);
}

}  // namespace
}  // namespace mosbench
