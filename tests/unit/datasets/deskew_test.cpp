#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Key;
using testing::Pair;

constexpr int kScansSwept = 6, kPointsOfTurn = 720;
constexpr double kPeriod_s = 0.1;

/// A sensor that drives a curve, 5 m/s at first.
struct Drive {
  double acceleration_m_s2 = 0;

  Pose at(double time_s) const {
    Pose pose = Pose::Identity();
    const double yaw_rad = 0.1 * time_s;
    pose.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const double path_m = 5 * time_s + 0.5 * acceleration_m_s2 * time_s * time_s;
    pose.translation() = Eigen::Vector3d(path_m, 0.25 * time_s * time_s, 0.2 * time_s);
    return pose;
  }
};

/// A point of a scan as the sensor sees it when it is measured.
Eigen::Vector3d measured(int i) {
  const double azimuth_rad = 2 * std::numbers::pi * (i + 0.5) / kPointsOfTurn - std::numbers::pi;
  const double range_m = 8 + i % 13;
  return {range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad), 0.1 * (i % 7)};
}
/// When it is measured, after the stamp: behind first, then clockwise.
double turned_s(int i) { return kPeriod_s * (0.5 - (i + 0.5) / kPointsOfTurn); }
/// The same, with the stamp at the beginning.
double begun_s(int i) { return kPeriod_s * i / kPointsOfTurn; }

class DeskewedScans : public testing::Test {
 protected:
  /// Writes a sequence of the drive whose points were measured at these times after the stamp.
  void write(const Drive& drive, double (*time_s)(int), bool with_column) {
    drive_ = drive;
    time_s_ = time_s;
    std::string times;
    std::vector<Pose> poses;
    for (int k = 0; k < kScansSwept; ++k) {
      std::string bytes;
      for (int i = 0; i < kPointsOfTurn; ++i) {
        const Eigen::Vector3f p = measured(i).cast<float>();
        const float row[] = {p.x(), p.y(), p.z(), 0.5F, static_cast<float>(time_s(i))};
        bytes.append(reinterpret_cast<const char*>(row), (with_column ? 5 : 4) * sizeof(float));
      }
      folder_.write("s/velodyne/00000" + std::to_string(k) + ".bin", bytes);
      times += std::to_string(k * kPeriod_s) + "\n";
      poses.push_back(drive.at(k * kPeriod_s));
    }
    folder_.write("s/times.txt", times);
    write_poses(folder_ / "s" / "poses.txt", poses);
  }
  /// Writes the scans again as files of this extension with their times in a field.
  void turn_into(const std::string& extension, const std::string& field, double per_s) const {
    for (int k = 0; k < kScansSwept; ++k) {
      const std::filesystem::path bin =
          folder_ / "s/velodyne" / ("00000" + std::to_string(k) + ".bin");
      const std::string bytes = read_file(bin);
      const std::vector<Point> points = parse_bin(bytes, 5, bin);
      const std::string count = std::to_string(points.size());
      std::string text =
          extension == ".ply"
              ? "ply\nformat ascii 1.0\nelement vertex " + count +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty double " +
                    field + "\nend_header\n"
              : "VERSION 0.7\nFIELDS x y z " + field +
                    "\nSIZE 4 4 4 8\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " + count +
                    "\nHEIGHT 1\nPOINTS " + count + "\nDATA ascii\n";
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Point& p = points[i];
        for (const double number :
             {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z),
              per_s * time_s_(static_cast<int>(i))}) {
          std::array<char, 32> digits{};
          std::snprintf(digits.data(), digits.size(), "%.9g ", number);
          text += digits.data();
        }
        text += "\n";
      }
      write_file_atomic(std::filesystem::path(bin).replace_extension(extension), text);
      std::filesystem::remove(bin);
    }
  }
  /// How far points lie at most from where the sensor would have seen them at the stamp, metres.
  double worst_m(const Reading& reading, int first, int last) const {
    const Dataset dataset = open_dataset(folder_ / "s", {.reading = reading});
    double worst = 0;
    for (int k = first; k <= last; ++k) {
      const Frame frame = dataset.sequences.at(0)->read(static_cast<std::size_t>(k));
      EXPECT_EQ(frame.points.size(), static_cast<std::size_t>(kPointsOfTurn));
      const Pose stamp_from_map = drive_.at(k * kPeriod_s).inverse();
      for (int i = 0; i < kPointsOfTurn; ++i) {
        const Point& p = frame.points[static_cast<std::size_t>(i)];
        const Eigen::Vector3d seen =
            stamp_from_map * drive_.at(k * kPeriod_s + time_s_(i)) * measured(i);
        worst = std::max(worst, (Eigen::Vector3d(p.x, p.y, p.z) - seen).norm());
      }
    }
    return worst;
  }
  std::string error_of(const Reading& reading) const {
    return message_of<DataError>(
        [&] { open_dataset(folder_ / "s", {.reading = reading}).sequences.at(0)->read(0); });
  }

  TempFolder folder_;
  Drive drive_;
  double (*time_s_)(int) = nullptr;
};

Reading by_column(std::optional<Deskew> deskew) {
  return {.deskew = deskew, .point_times = PointTimes::kColumn, .bin_columns = 5};
}
Reading by_azimuth(std::optional<Deskew> deskew) {
  return {.deskew = deskew, .point_times = PointTimes::kAzimuth};
}

TEST_F(DeskewedScans, ComeBackWithinAMillimetreByTimesInTheFifthColumn) {
  write({}, begun_s, true);
  ASSERT_GT(worst_m(by_column(Deskew::kNone), 0, kScansSwept - 1), 0.45);
  EXPECT_LT(worst_m(by_column(Deskew::kVelocity), 0, kScansSwept - 1), 1e-3);
  EXPECT_LT(worst_m(by_column(Deskew::kPoses), 0, kScansSwept - 2), 1e-3);
  EXPECT_LT(worst_m(by_column(std::nullopt), 0, kScansSwept - 2), 1e-3);
  // No pose follows the last one.
  EXPECT_GT(worst_m(by_column(Deskew::kPoses), kScansSwept - 1, kScansSwept - 1), 0.45);
}

TEST_F(DeskewedScans, ComeBackWithinAMillimetreByTimesInAFieldOfEveryUnit) {
  for (const auto& [field, per_s] :
       {std::pair{"t", 1e9}, {"offset_time", 1e6}, {"time", 1.0}, {"timestamp", 1e3}}) {
    for (const char* extension : {".ply", ".pcd"}) {
      std::filesystem::remove_all(folder_ / "s");
      write({}, begun_s, true);
      turn_into(extension, field, per_s);
      Reading reading = by_column(Deskew::kPoses);
      EXPECT_LT(worst_m(reading, 0, kScansSwept - 2), 1e-3) << field << extension;
      reading.deskew = Deskew::kNone;
      EXPECT_GT(worst_m(reading, 0, kScansSwept - 2), 0.45);
      reading.deskew = std::nullopt;
      EXPECT_THAT(
          members_of(open_dataset(folder_ / "s", {.reading = reading}).sequences[0]->reading()),
          Contains(Pair("point_times", HasSubstr("since the scan's stamp, span"))));
    }
  }
}

TEST_F(DeskewedScans, ComeBackWithinMillimetresByTheirAzimuths) {
  write({}, turned_s, false);
  ASSERT_GT(worst_m(by_azimuth(Deskew::kNone), 0, kScansSwept - 1), 0.2);
  // The way between two stamps is taken for straight, also backwards: a turn of 0.1 rad/s.
  EXPECT_LT(worst_m(by_azimuth(Deskew::kVelocity), 0, kScansSwept - 1), 2e-3);
  EXPECT_LT(worst_m(by_azimuth(Deskew::kPoses), 1, kScansSwept - 2), 1e-3);
  // Without stamps a turn is taken to last 0.1 s.
  std::filesystem::remove(folder_ / "s" / "times.txt");
  EXPECT_LT(worst_m(by_azimuth(Deskew::kPoses), 1, kScansSwept - 2), 1e-3);
}

TEST_F(DeskewedScans, FollowAnAccelerationByPosesBetterThanByVelocity) {
  write({.acceleration_m_s2 = 2}, begun_s, true);
  const double by_velocity_m = worst_m(by_column(Deskew::kVelocity), 1, kScansSwept - 2);
  const double by_poses_m = worst_m(by_column(Deskew::kPoses), 1, kScansSwept - 2);
  EXPECT_LT(by_poses_m, 4e-3);
  EXPECT_GT(by_velocity_m, 10e-3);
  EXPECT_LT(by_velocity_m, 30e-3);
}

TEST_F(DeskewedScans, AreStatedAndAreReadAsStoredUnlessTheyAreAskedFor) {
  write({}, begun_s, true);
  const Dataset plain = open_dataset(folder_ / "s", {.reading = {.bin_columns = 5}});
  EXPECT_THAT(members_of(plain.sequences[0]->reading()), testing::Not(Contains(Key("deskew"))));
  const Frame stored = plain.sequences[0]->read(2);
  EXPECT_TRUE(stored.point_times_ns.empty());
  const Dataset moved = open_dataset(folder_ / "s", {.reading = by_column(std::nullopt)});
  EXPECT_THAT(members_of(moved.sequences[0]->reading()), Contains(Pair("deskew", "poses")));
  EXPECT_THAT(members_of(moved.sequences[0]->reading()),
              Contains(Pair("point_times", HasSubstr("s since the scan's stamp, span"))));
  EXPECT_TRUE(moved.sequences[0]->read(2).point_times_ns.empty());
  // The first point was measured at the stamp and keeps its bits.
  EXPECT_EQ(moved.sequences[0]->read(2).points[0].x, stored.points[0].x);
  Reading unposed = by_column(std::nullopt);
  unposed.poses = ByOdometry{};
  const Frame frame = open_dataset(folder_ / "s", {.reading = unposed}).sequences[0]->read(2);
  EXPECT_EQ(format_bin(frame.points), format_bin(stored.points));
  ASSERT_EQ(frame.point_times_ns.size(), frame.points.size());
  EXPECT_NEAR(static_cast<double>(frame.point_times_ns[kPointsOfTurn / 2]), 0.05e9, 10);
}

TEST_F(DeskewedScans, KeepMissingReturnsWhereTheyAre) {
  write({}, begun_s, true);
  const std::filesystem::path file = folder_ / "s/velodyne/000002.bin";
  std::string bytes = read_file(file);
  constexpr std::size_t kMissing = 300;
  std::fill_n(bytes.begin() + kMissing * 5 * sizeof(float), 3 * sizeof(float), '\0');
  folder_.write("s/velodyne/000002.bin", bytes);
  const Dataset moved = open_dataset(folder_ / "s", {.reading = by_column(Deskew::kPoses)});
  const Point missing = moved.sequences[0]->read(2).points[kMissing];
  EXPECT_EQ(std::abs(missing.x) + std::abs(missing.y) + std::abs(missing.z), 0.0F);
}

TEST_F(DeskewedScans, AreRefusedWithoutSensibleTimes) {
  write({}, begun_s, false);
  Reading four = by_column(std::nullopt);
  four.bin_columns = 4;
  EXPECT_THAT(error_of(four),
              HasSubstr("000000.bin: holds no times of points, expected a field t, time, timestamp "
                        "or offset_time in .pcd and .ply files, bin_columns 5 for .bin files"));
}

TEST_F(DeskewedScans, OfPcdAndPlyFilesWithTimesAreMovedUnlessToldOtherwise) {
  for (const char* extension : {".ply", ".pcd"}) {
    std::filesystem::remove_all(folder_ / "s");
    write({}, begun_s, true);
    turn_into(extension, "time_stamp", 1e6);
    EXPECT_LT(worst_m({}, 0, kScansSwept - 2), 1e-3) << extension;
    EXPECT_GT(worst_m({.deskew = Deskew::kNone}, 0, kScansSwept - 2), 0.45);
    std::filesystem::remove(folder_ / "s/times.txt");
    const Dataset unstamped = open_dataset(folder_ / "s", {});
    EXPECT_THAT(unstamped.sequences[0]->remarks(),
                Contains(HasSubstr("not used, as scans have no stamps")));
    EXPECT_GT(worst_m({}, 0, kScansSwept - 2), 0.45);
  }
}

TEST(AzimuthTimes, RunClockwiseFromBehindAndAreNoneForPointsWithoutDirection) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Point> points = {{-1, 1e-9F, 0, 0}, {0, 1, 0, 0}, {1, 0, 5, 0},
                                     {0, -1, 0, 0},     {0, 0, 0, 0}, {nan, 1, 0, 0}};
  EXPECT_THAT(azimuth_times_ns(points, 100'000'000),
              testing::ElementsAre(-50'000'000, -25'000'000, 0, 25'000'000, 0, 0));
}

}  // namespace
}  // namespace mosbench
