#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>

#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/errors.hpp"
#include "tests/bag_bytes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

/// Two rows of three points, each 20 bytes long, x counting from 0.
struct OddCloud {
  CloudHead head;
  std::string records;
};

OddCloud odd_cloud(std::uint32_t height, std::uint32_t width, std::uint32_t padding_bytes) {
  OddCloud cloud;
  cloud.head = parse_cloud_head(timed_cloud(5, std::vector<Point>(6), {}), "f");
  cloud.head.height = height;
  cloud.head.width = width;
  cloud.head.row_step_bytes = width * 20 + padding_bytes;
  ByteSink records;
  for (std::uint32_t i = 0; i < height * width; ++i) {
    records.put(Point{static_cast<float>(i), 1, 2, 3});
    records.put(std::uint32_t{7});
    if ((i + 1) % width == 0) records.put_bytes(std::string(padding_bytes, 'p'));
  }
  cloud.records = std::move(records).bytes();
  return cloud;
}

/// The same with the bytes of each number the other way round.
OddCloud big_endian(OddCloud cloud) {
  cloud.head.big_endian = true;
  for (std::size_t at = 0; at + 4 <= cloud.records.size(); at += 4) {
    std::reverse(cloud.records.begin() + static_cast<std::ptrdiff_t>(at),
                 cloud.records.begin() + static_cast<std::ptrdiff_t>(at + 4));
  }
  return cloud;
}

void expect_read(const OddCloud& cloud, const std::string& what) {
  for (const auto encoding :
       {MessageEncoding::kRos1, MessageEncoding::kCdr, MessageEncoding::kCdrBigEndian}) {
    // The records stay little endian, as the head says.
    const std::vector<Point> points = parse_cloud(format_cloud(cloud.head, cloud.records, encoding),
                                                  "f", {kPointCloud2, encoding})
                                          .points;
    ASSERT_EQ(points.size(), 6U) << what;
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_EQ(points[i].x, static_cast<float>(i)) << what;
      ASSERT_EQ(points[i].intensity, 3.0F) << what;
    }
  }
}

TEST(CloudSizes, AreThoseOfThePointsWhereTheRowStepDoesNotFit) {
  for (const std::uint32_t height : {1U, 2U, 3U, 6U}) {
    const std::uint32_t width = 6 / height;
    for (const std::uint32_t step :
         {0U, 1U, width, width * 16, width * 20 - 1, 6U * 20U, 6U * 20U + 1, 4'000'000'000U}) {
      OddCloud cloud = odd_cloud(height, width, 0);
      cloud.head.row_step_bytes = step;
      expect_read(cloud, std::to_string(height) + " rows, step " + std::to_string(step));
    }
    for (const std::uint32_t padding_bytes : {0U, 4U, 33U}) {
      OddCloud cloud = odd_cloud(height, width, padding_bytes);
      expect_read(cloud, "padded");
      cloud.records += std::string(19, 'x');
      expect_read(cloud, "followed by other bytes");
    }
  }
}

TEST(CloudBytes, AreReadInTheOrderThatTheHeadNames) {
  const OddCloud cloud = big_endian(odd_cloud(2, 3, 0));
  EXPECT_NE(cloud.records, odd_cloud(2, 3, 0).records);
  expect_read(cloud, "big endian");
  const auto times = parse_cloud(format_cloud(cloud.head, cloud.records, MessageEncoding::kRos1),
                                 "f", {kPointCloud2, MessageEncoding::kRos1}, true)
                         .times;
  EXPECT_EQ(times, std::vector<double>(6, 7.0));
}

TEST(CloudSizes, OfNothingAreThoseOfTheBytes) {
  for (const auto& [height, width] : {std::pair{0U, 6U}, {6U, 0U}, {0U, 0U}}) {
    OddCloud cloud = odd_cloud(1, 6, 0);
    cloud.head.height = height;
    cloud.head.width = width;
    expect_read(cloud, "without a height or width");
    cloud.records.clear();
    EXPECT_TRUE(parse_cloud(format_cloud(cloud.head, ""), "f").points.empty());
  }
}

TEST(CloudSizes, TooSmallForThePointsAreRefused) {
  for (const std::uint32_t height : {1U, 2U}) {
    for (const std::uint32_t step : {0U, 60U, 120U}) {
      OddCloud cloud = odd_cloud(height, 6 / height, 0);
      cloud.head.row_step_bytes = step;
      cloud.records.pop_back();
      EXPECT_THAT(
          message_of<DataError>([&] { parse_cloud(format_cloud(cloud.head, cloud.records), "f"); }),
          HasSubstr("has 119 bytes, expected all its points"));
    }
  }
}

TEST(CloudFields, AreOneNumberAlsoWithACountOfZeroOrOfThePoints) {
  for (const std::uint32_t count : {0U, 1U, 6U, 480U, 0xFFFFFFFFU}) {
    for (std::size_t changed = 0; changed <= 5; ++changed) {
      OddCloud cloud = odd_cloud(1, 6, 0);
      for (std::size_t i = 0; i < 5; ++i) {
        if (changed == 5 || changed == i) cloud.head.fields[i].count = count;
      }
      expect_read(cloud, "count " + std::to_string(count));
    }
  }
}

TEST(LfsPointers, AreNamedByEveryReader) {
  const TempFolder folder;
  const auto pointer = [&](const char* name) {
    std::ofstream(folder.path() / name)
        << "version https://git-lfs.github.com/spec/v1\noid sha256:" << std::string(64, 'a')
        << "\nsize 123456789\n";
    return folder.path() / name;
  };
  const auto expect_named = [](const std::function<void()>& read) {
    EXPECT_THAT(message_of<DataError>(read), HasSubstr("is a Git LFS pointer"));
  };
  for (const char* name : {"s.bin", "s.pcd", "s.ply", "s.pcd.bin"}) {
    const auto file = pointer(name);
    expect_named([&] { read_scan(file); });
    expect_named([&] { read_scan_head(file); });
  }
  for (const char* name : {"d.bag", "d.mcap", "d.db3", "d.mcap.zstd"}) {
    const auto file = pointer(name);
    expect_named([&] { open_bag(file); });
  }
  const auto poses = pointer("poses.txt");
  expect_named([&] { read_poses(poses); });
}

}  // namespace
}  // namespace mosbench
