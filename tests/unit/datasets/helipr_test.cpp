#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/helipr_points.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/sequence_names.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kOld_ns = 1691936557946849179;
constexpr std::int64_t kNew_ns = kOld_ns + 1;
constexpr const char* kStill = " 1 2 3 0 0 0 1\n";

/// Two points of an Aeva, the second 0.5 s after the stamp, at -7.5 m/s.
std::string aeva(bool has_intensity) {
  ByteSink sink;
  for (const float x : {1.0F, 2.0F}) {
    for (const float number : {x, 20.0F, 30.0F, 0.25F, x - 9.5F}) sink.put(number);
    sink.put(x == 1.0F ? std::int32_t{-1000} : std::int32_t{500'000'000});
    sink.put(std::uint8_t{3});
    if (has_intensity) sink.put(60.0F);
  }
  return std::move(sink).bytes();
}

template <typename... Rest>
std::string point_with(Rest... rest) {
  ByteSink sink;
  for (const float number : {1.0F, 2.0F, 3.0F}) sink.put(number);
  (sink.put(rest), ...);
  return std::move(sink).bytes();
}

TEST(HeliprPoints, OfAnAevaHaveVelocitiesAndSinceAStampIntensities) {
  for (const bool is_new : {false, true}) {
    const HeliprScan scan =
        parse_helipr_scan(aeva(is_new), HeliprSensor::kAeva, is_new ? kNew_ns : kOld_ns, "f.bin");
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[1].x, 2.0F);
    EXPECT_EQ(scan.points[1].z, 30.0F);
    EXPECT_EQ(scan.points[1].intensity, is_new ? 60.0F : 0.25F);
    EXPECT_THAT(scan.radial_velocity_m_s, ElementsAre(-8.5F, -7.5F));
    EXPECT_THAT(scan.times_ns, ElementsAre(-1000, 500'000'000));
  }
}

TEST(HeliprPoints, OfTheOtherLidarsHaveTimesAndIntensities) {
  struct Case {
    HeliprSensor sensor;
    std::string bytes;
    float intensity;
  };
  const std::vector<Case> cases = {
      {HeliprSensor::kAvia,
       point_with(std::uint8_t{200}, std::uint8_t{16}, std::uint8_t{5}, std::uint32_t{20'000'000}),
       200.0F},
      {HeliprSensor::kOuster,
       point_with(75.5F, std::uint32_t{20'000'000}, std::array<std::uint16_t, 3>{1, 2, 3}), 75.5F},
      {HeliprSensor::kVelodyne, point_with(12.0F, std::uint16_t{7}, 0.02F), 12.0F}};
  for (const Case& each : cases) {
    SCOPED_TRACE(to_string(each.sensor));
    EXPECT_EQ(each.bytes.size(), helipr_point_bytes(each.sensor, kOld_ns));
    const HeliprScan scan =
        parse_helipr_scan(each.bytes + each.bytes, each.sensor, kOld_ns, "f.bin");
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[1].y, 2.0F);
    EXPECT_EQ(scan.points[1].intensity, each.intensity);
    EXPECT_NEAR(static_cast<double>(scan.times_ns[1]), 2e7, 1.0);
    EXPECT_THAT(scan.radial_velocity_m_s, IsEmpty());
    EXPECT_THAT(message_of<DataError>(
                    [&] { parse_helipr_scan(each.bytes + "x", each.sensor, kOld_ns, "f.bin"); }),
                HasSubstr("bytes are no multiple of"));
  }
  EXPECT_THAT(message_of<DataError>([&] {
                parse_helipr_scan(point_with(1.0F, std::uint16_t{0}, 4.0F), HeliprSensor::kVelodyne,
                                  kOld_ns, "f.bin");
              }),
              HasSubstr("f.bin:0: is measured 4 s after the stamp"));
}

TEST(HeliprPoints, AreWrittenAsAnAevaStoresThem) {
  const std::vector<Point> points = {{1, 2, 3, 0.5F}, {4, 5, 6, 0.25F}};
  const std::vector<float> velocities = {-8.5F, 0.125F};
  for (const std::int64_t stamp_ns : {kOld_ns, kNew_ns}) {
    const std::string bytes = format_helipr_aeva(points, velocities, stamp_ns);
    EXPECT_EQ(bytes.size(), 2 * helipr_point_bytes(HeliprSensor::kAeva, stamp_ns));
    const HeliprScan scan = parse_helipr_scan(bytes, HeliprSensor::kAeva, stamp_ns, "f.bin");
    EXPECT_EQ(scan.radial_velocity_m_s, velocities);
    EXPECT_THAT(scan.times_ns, ElementsAre(0, 0));
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[1].z, 6.0F);
    EXPECT_EQ(scan.points[1].intensity, 0.25F);
  }
}

TEST(HeliprPoses, AreRowsWithStamps) {
  const auto poses = parse_helipr_poses("5 1 2 3 0 0 0 1\n9 4 5 6 0 0 1 0\n", "f.txt");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[1].stamp_ns, 9);
  EXPECT_EQ(poses[1].map_from_sensor.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(poses[1].map_from_sensor.linear()(0, 0), -1.0);
  EXPECT_EQ(parse_helipr_poses(format_helipr_poses(poses), "f").size(), 2U);
  for (const char* row :
       {"5 1 2 3 0 0 0", "5.5 1 2 3 0 0 0 1", "-5 1 2 3 0 0 0 1", "5 1 2 3 0 0 0 2",
        "5 nan 2 3 0 0 0 1", "18446744073709551615 1 2 3 0 0 0 1"}) {
    EXPECT_THAT(message_of<DataError>([&] { parse_helipr_poses(row, "f.txt"); }),
                HasSubstr("f.txt:1:"))
        << row;
  }
}

class HeliprFolder : public testing::Test {
 protected:
  HeliprFolder() {
    for (const std::int64_t stamp_ns : {kOld_ns, kNew_ns}) {
      folder_.write("set/KAIST05/LiDAR/Aeva/" + std::to_string(stamp_ns) + ".bin",
                    aeva(stamp_ns == kNew_ns));
    }
    folder_.write("set/KAIST05/LiDAR/Velodyne/700.bin", point_with(1.0F, std::uint16_t{0}, 0.0F));
    folder_.write("set/KAIST05/LiDAR_GT/Aeva_gt.txt",
                  std::to_string(kOld_ns) + kStill + std::to_string(kNew_ns) + kStill);
    folder_.write("set/KAIST05/LiDAR_GT/Velodyne_gt.txt", std::string("700") + kStill);
  }

  TempFolder folder_;
};

TEST_F(HeliprFolder, IsReadFromAnyPlace) {
  for (const char* place : {"set", "set/KAIST05", "set/KAIST05/LiDAR/Aeva"}) {
    const Dataset dataset = open_dataset(folder_ / place, {});
    EXPECT_EQ(dataset.kind, DatasetKind::kHelipr);
    const Sequence& scans = *dataset.sequences.at(0);
    ASSERT_EQ(scans.size(), 2U);
    const Frame frame = scans.read(1);
    EXPECT_EQ(frame.stamp_ns, kNew_ns);
    EXPECT_THAT(frame.radial_velocity_m_s, ElementsAre(-8.5F, -7.5F));
    EXPECT_THAT(frame.point_times_ns, IsEmpty());
    EXPECT_EQ(frame.map_from_sensor.translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_FALSE(frame.truth);
  }
  EXPECT_THAT(sequence_names(open_dataset(folder_ / "set", {})),
              ElementsAre("KAIST05/Aeva", "KAIST05/Velodyne"));
}

TEST_F(HeliprFolder, LeavesScansWithoutPoseOut) {
  folder_.write("set/KAIST05/LiDAR_GT/Aeva_gt.txt", std::to_string(kNew_ns) + kStill);
  const Dataset dataset = open_dataset(folder_ / "set/KAIST05/LiDAR/Aeva", {});
  EXPECT_EQ(dataset.sequences.at(0)->size(), 1U);
  EXPECT_THAT(dataset.sequences.at(0)->recording().doubts,
              Contains("left out 1 of 2 scans: no pose in Aeva_gt.txt"));
}

TEST_F(HeliprFolder, LeavesScansBetweenDistantPosesOut) {
  const std::string scan = point_with(1.0F, std::uint16_t{0}, 0.0F);
  for (const char* stamp : {"5000000700", "10000000700"}) {
    folder_.write(std::string("set/KAIST05/LiDAR/Velodyne/") + stamp + ".bin", scan);
  }
  folder_.write("set/KAIST05/LiDAR_GT/Velodyne_gt.txt",
                std::string("700") + kStill + "10000000700" + kStill);
  const auto scans = [&](double max_gap_s) {
    const Dataset dataset = open_dataset(folder_ / "set/KAIST05/LiDAR/Velodyne",
                                         {.reading = {.max_pose_gap_s = max_gap_s}});
    return dataset.sequences.at(0)->size();
  };
  EXPECT_EQ(scans(9.9), 2U);
  EXPECT_EQ(scans(10.1), 3U);
}

TEST_F(HeliprFolder, NamesTheScanThatIsNone) {
  folder_.write("set/KAIST05/LiDAR/Velodyne/800.bin", "short");
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "set", {}); }),
              HasSubstr("800.bin: 5 bytes are no multiple of 22, expected points of HeLiPR's"));
}

}  // namespace
}  // namespace mosbench
