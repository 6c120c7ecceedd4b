#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/errors.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// SHA-256 of points as .bin holds them, by coreutils.
std::string sha256_of(const std::vector<Point>& points) {
  const TempFolder folder;
  write_bin(folder / "points", points);
  FILE* pipe = popen(("sha256sum " + (folder / "points").string()).c_str(), "r");
  std::array<char, 65> digits{};
  const std::size_t got = std::fread(digits.data(), 1, 64, pipe);
  pclose(pipe);
  return std::string(digits.data(), got);
}

class RealBag : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = shared_folder() / "real/rosbag";
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
    expected_ = nlohmann::json::parse(read_file(folder_ / "expected.json")).at(GetParam());
  }
  std::filesystem::path bag() const { return folder_ / GetParam(); }

  std::filesystem::path folder_;
  nlohmann::json expected_;
};

TEST_P(RealBag, GivesTheRecordedScansBitForBit) {
  const BagSequence recording("s", bag(), {.deskew = Deskew::kNone});
  const auto& scans = expected_.at("scans");
  ASSERT_GE(scans.size(), 3U);
  ASSERT_EQ(recording.size(), scans.size());
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const Frame frame = recording.read(i);
    EXPECT_EQ(frame.stamp_ns, scans[i].at("stamp_ns").get<std::int64_t>());
    EXPECT_EQ(recording.point_count(i), scans[i].at("points").get<std::size_t>());
    EXPECT_EQ(frame.points.size(), recording.point_count(i));
    EXPECT_EQ(sha256_of(frame.points), scans[i].at("xyzi_sha256").get<std::string>());
  }
}

TEST_P(RealBag, GivesTheRecordedPoses) {
  const BagSequence recording("s", bag(), {.deskew = Deskew::kNone});
  const auto& transforms = expected_.at("tf");
  ASSERT_GE(transforms.size(), 3U);
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    const Pose pose = recording.read(i).map_from_sensor;
    const auto t = transforms[i].at("t").get<std::array<double, 3>>();
    const auto q = transforms[i].at("q_xyzw").get<std::array<double, 4>>();
    EXPECT_EQ(recording.stamp_ns(i), transforms[i].at("stamp_ns").get<std::int64_t>());
    EXPECT_EQ(pose.translation(), Eigen::Vector3d(t[0], t[1], t[2]));
    const Eigen::Quaterniond stored(q[3], q[0], q[1], q[2]);
    EXPECT_EQ(pose.linear(), stored.normalized().toRotationMatrix());
  }
}

TEST_P(RealBag, HoldsTheTransformsBitForBit) {
  const auto file = open_bag(bag());
  const auto messages = file->messages("/tf");
  const auto& transforms = expected_.at("tf");
  ASSERT_EQ(messages.size(), transforms.size());
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::string bytes = file->read(messages[i]);
    ASSERT_GE(bytes.size(), 56U);
    std::array<double, 7> stored{};
    std::memcpy(stored.data(), bytes.data() + bytes.size() - sizeof(stored), sizeof(stored));
    const auto t = transforms[i].at("t").get<std::array<double, 3>>();
    const auto q = transforms[i].at("q_xyzw").get<std::array<double, 4>>();
    EXPECT_EQ(stored, (std::array{t[0], t[1], t[2], q[0], q[1], q[2], q[3]}));
  }
}

INSTANTIATE_TEST_SUITE_P(Bags, RealBag,
                         testing::Values("xyzi_none.bag", "ouster48_lz4.bag", "ouster48_bz2.bag"),
                         [](const auto& bag) {
                           const std::string name = bag.param;
                           return name.substr(0, name.find('.'));
                         });

TEST(RealBagWithTimes, IsUndistortedAndLeavesOutTheScanThatTheTransformsDoNotCover) {
  const auto bag = shared_folder() / "real/rosbag/ouster48_lz4.bag";
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << bag << " is not there";
  const BagSequence raw("s", bag, {.deskew = Deskew::kNone});
  const BagSequence recording("s", bag, {});
  ASSERT_EQ(raw.size(), 3U);
  ASSERT_EQ(recording.size(), 2U);
  EXPECT_THAT(recording.recording().doubts,
              testing::Contains(HasSubstr("1 of 3 scans are left out: no transform covers them")));
  double furthest_m = 0.0;
  const auto before = raw.read(0).points;
  const auto after = recording.read(0).points;
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    furthest_m = std::max<double>(furthest_m, std::abs(after[i].x - before[i].x));
    ASSERT_EQ(after[i].intensity, before[i].intensity);
  }
  // The car went 0.35 m during the scan and turned by 0.015 rad, which at 80 m adds 1.2 m.
  EXPECT_GT(furthest_m, 0.25);
  EXPECT_LT(furthest_m, 1.6);
}

TEST(RealBagWithoutScans, SaysWhatItHoldsInstead) {
  const auto bag = shared_folder() / "real/rosbag/robot_without_pointcloud2.bag";
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << bag << " is not there";
  EXPECT_THAT(message_of<DataError>([&] { BagSequence("s", bag, {}); }),
              AllOf(HasSubstr("holds no sensor_msgs/PointCloud2 but /scan"),
                    HasSubstr("expected scans as PointCloud2; of a folder with bags sequences")));
}

}  // namespace
}  // namespace mosbench
