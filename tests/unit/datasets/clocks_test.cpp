#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "datasets/rosbag/bag_turns.hpp"
#include "datasets/sequence/pose_clock.hpp"
#include "tests/unit/datasets/drive_bags.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// A sensor that turns unevenly, or drives evenly, in a room of 24 x 16 x 4 m.
Pose room_from_sensor(double time_s, bool evenly) {
  Pose pose = Pose::Identity();
  const double turn = evenly ? 0.1 * time_s : 0.8 * time_s + 0.3 * std::sin(3.0 * time_s);
  pose.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(4.0 * time_s - 6.0, 0.0, 1.6);
  // A curve of one radius is the same motion at all times.
  if (evenly) {
    pose.translation() = Eigen::Vector3d(5.0 * std::sin(turn), 5.0 - 5.0 * std::cos(turn), 1.6);
  }
  return pose;
}

std::vector<Point> view_of_room(const Pose& pose, double mounted_rad = 0.0) {
  const Eigen::Array3d low_m(-12.0, -8.0, 0.0), high_m(12.0, 8.0, 4.0);
  std::vector<Point> points;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 12; ++j) {
      const double azimuth = 2.0 * M_PI * i / 60.0, elevation = -0.35 + 0.6 * j / 11.0;
      const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      const Eigen::Vector3d turned = Eigen::AngleAxisd(mounted_rad, Eigen::Vector3d::UnitZ()) * ray;
      const Eigen::Array3d in_room = (pose.linear() * turned).array();
      const Eigen::Array3d to_wall = (in_room > 0.0).select(high_m, low_m);
      const double range =
          ((to_wall - pose.translation().array()) / (in_room + 1e-12)).abs().minCoeff();
      const Eigen::Vector3f point_m = (range * ray).cast<float>();
      points.push_back({point_m.x(), point_m.y(), point_m.z(), 1.0F});
    }
  }
  return points;
}

std::int64_t ns(double time_s) { return std::llround(1e9 * time_s); }

/// Scans of a room with poses by a clock that is so far ahead.
class RoomDrive : public Sequence {
 public:
  RoomDrive(std::size_t scans, bool evenly, double ahead_s) : evenly_(evenly), ahead_s_(ahead_s) {
    for (std::size_t k = 0; k < scans; ++k) {
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stamp_ns = static_cast<std::int64_t>(k) * 100'000'000;
      entry.map_from_sensor = pose_at(*entry.stamp_ns);
    }
  }
  Pose pose_at(std::int64_t time_ns) const {
    return room_from_sensor(1e-9 * static_cast<double>(time_ns) - ahead_s_, evenly_);
  }
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    describe(scan_index, frame);
    frame.points = view_of_room(room_from_sensor(0.1 * static_cast<double>(scan_index), evenly_));
  }
  std::string doubt() const {
    const auto doubt = doubt_about_clock(
        *this, [&](std::int64_t time_ns) { return std::optional(pose_at(time_ns)); });
    return doubt ? to_string(*doubt) : "";
  }

 private:
  bool evenly_;
  double ahead_s_;
};

TEST(PoseClock, IsDoubtedWithTheTimeByWhichItIsOff) {
  for (const auto& [ahead_s, said, mended] :
       {std::tuple{0.05, "poses of 50 ms after", "pose_offset_s -0.05 reads"},
        {-0.05, "poses of 50 ms before", "pose_offset_s 0.05 reads"},
        {0.15, "poses of 150 ms after", "pose_offset_s -0.15 reads"},
        {0.3, "poses of 300 ms after", "pose_offset_s -0.3 reads"},
        {-0.7, "poses of 700 ms before", "pose_offset_s 0.7 reads"}}) {
    EXPECT_THAT(RoomDrive(12, false, ahead_s).doubt(), AllOf(HasSubstr(said), HasSubstr(mended)));
  }
}

TEST(PoseClock, IsMendedByTheOffsetOfStampsAndNotByOneCloseToIt) {
  for (const auto& [fitted_s, expected_s] : {std::pair{-0.33, -0.3}, {0.1, 0.1}}) {
    Recording recording;
    recording.reading.poses.fitting_offset_s = -0.3;
    add_clock_doubt(recording, {"other clocks", fitted_s});
    EXPECT_EQ(recording.reading.poses.fitting_offset_s, expected_s);
    EXPECT_THAT(recording.doubts.at(0), HasSubstr(fmt::format("pose_offset_s {} ", expected_s)));
  }
  EXPECT_EQ(fmt::format("{}", mending_offset_s(-0.2, -0.2)), "0");
  EXPECT_EQ(fmt::format("{}", mending_offset_s(0.0, 0.0001)), "0");
}

TEST(PoseClock, IsNotDoubtedWhereItFitsOrChangesNothing) {
  for (const double ahead_s : {0.0, 0.002}) EXPECT_EQ(RoomDrive(12, false, ahead_s).doubt(), "");
  for (const double ahead_s : {0.0, 0.05, 0.5}) {
    EXPECT_EQ(RoomDrive(12, true, ahead_s).doubt(), "") << ahead_s;
  }
  EXPECT_EQ(RoomDrive(3, false, 0.3).doubt(), "") << "three scans show nothing";
  EXPECT_FALSE(doubt_about_clock(RoomDrive(12, false, 0.3), {})) << "poses without stamps";
}

TEST(ScansInTurn, OfTwoSensorsAreDoubted) {
  const auto doubt = [](std::size_t scans, double mounted_rad) {
    return doubt_about_turns(scans, [=](std::size_t k) {
      return view_of_room(room_from_sensor(0.05 * static_cast<double>(k), false),
                          k % 2 == 0 ? 0.0 : mounted_rad);
    });
  };
  for (const std::size_t scans : {8U, 12U, 24U}) {
    EXPECT_FALSE(doubt(scans, 0.0)) << scans;
    EXPECT_THAT(doubt(scans, 2.0).value_or(""), HasSubstr("two sensors")) << scans;
  }
  for (const std::size_t scans : {0U, 1U, 3U}) EXPECT_FALSE(doubt(scans, 2.0)) << scans;
}

/// Clocks as the recorder shows them: scans last 0.1 s, and come `late_s` after their stamps.
class BagClocks : public BagPoses {
 protected:
  std::vector<std::string> doubts(double scans_late_s, double poses_late_s,
                                  const Reading& asked = {}) const {
    Drive drive;
    for (int k = 0; k < 12; ++k) {
      add_cloud(drive, at(k));
      drive.back().recorded_ns += ns(scans_late_s);
      add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
      drive.back().recorded_ns += ns(poses_late_s);
    }
    return open(drive, asked).recording().doubts;
  }
};

TEST_P(BagClocks, AreDoubtedWhereTheRecorderShowsThatTheyDiffer) {
  for (const double early_s : {0.05, 0.3, 1.0}) {
    EXPECT_THAT(doubts(-early_s, 0.0), Contains(HasSubstr("ahead of the recorder's"))) << early_s;
  }
  for (const double late_s : {0.5, 1.0}) {
    EXPECT_THAT(doubts(late_s, 0.002), Contains(HasSubstr("seem to differ"))) << late_s;
  }
}

TEST_P(BagClocks, AreNotDoubtedWhereMessagesComeLateOrPosesAreDatedAhead) {
  const auto clocks = Contains(HasSubstr("clock"));
  for (const double late_s : {0.001, 0.1, 0.3}) {
    EXPECT_THAT(doubts(late_s, 0.002), Not(clocks)) << late_s;
    EXPECT_THAT(doubts(late_s, -1.0), Not(clocks)) << late_s;
    EXPECT_THAT(doubts(late_s, 0.5), Not(clocks)) << late_s;
  }
  EXPECT_THAT(doubts(0.0, 0.0), Not(clocks)) << "a converter takes the stamps for both";
}

/// Scans that are stamped since the sensor began to run, poses since 1970.
TEST_P(BagClocks, ThatDifferByAConstantAreMendedByTheOffsetThatIsPrinted) {
  Drive drive;
  for (int k = 0; k < 12; ++k) {
    add_cloud(drive, at(k) - kDrive_ns + 600 * kStep_ns);
    drive.back().recorded_ns = at(k);
    add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
  }
  EXPECT_THAT(error_of(drive), HasSubstr("pose_offset_s -1699999940 reads"));
  const BagSequence mended = open(drive, {.pose_offset_s = -1699999940.0});
  EXPECT_EQ(mended.size(), 12U);
  EXPECT_EQ(xs_of(mended).back(), 11.0);
  EXPECT_THAT(mended.recording().doubts, Not(Contains(HasSubstr("clock"))));

  // Stamps that stand still are mended by no offset.
  for (DriveMessage& message : drive) {
    if (message.topic != "/points") continue;
    Drive stopped;
    add_cloud(stopped, 0);
    stopped.back().recorded_ns = message.recorded_ns;
    message = stopped.back();
  }
  EXPECT_THAT(error_of(drive), AllOf(HasSubstr("the times of recording would fit"),
                                     Not(HasSubstr("pose_offset_s"))));
}

TEST_P(BagClocks, OfScansWithTimesOfPointsAreComparedByTheirLastPoints) {
  std::vector<std::uint32_t> times_ns;
  for (std::uint32_t i = 0; i < 11; ++i) times_ns.push_back(i * 10'000'000);
  const std::vector<Point> points(times_ns.size(), {1, 0, 0, 1});
  Drive drive;
  for (int k = 0; k < 12; ++k) {
    const std::int64_t stamp_ns = at(k) - kDrive_ns + 600 * kStep_ns;
    drive.push_back(
        {"/points", std::string(kPointCloud2), at(k + 1), [=](MessageEncoding encoding) {
           return timed_cloud(stamp_ns, points, times_ns, encoding);
         }});
    add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
  }
  EXPECT_THAT(error_of(drive), HasSubstr("pose_offset_s -1699999940 reads"));
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, BagClocks,
                         testing::Values(DriveBag::kRos1, DriveBag::kMcap, DriveBag::kDb3));

}  // namespace
}  // namespace mosbench
