#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/chunk_reader.hpp"
#include "datasets/rosbag/message_format.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/text/errors.hpp"
#include "tests/bag_bytes.hpp"
#include "tests/mcap_bytes.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/pose_at_x.hpp"

namespace mosbench {

inline constexpr std::int64_t kDrive_ns = 1'700'000'000'000'000'000;
inline constexpr std::int64_t kStep_ns = 100'000'000;

/// Message of a drive before it is known what kind of bag keeps it.
struct DriveMessage {
  std::string topic, type;
  std::int64_t recorded_ns;
  std::function<std::string(MessageEncoding)> bytes;
};
using Drive = std::vector<DriveMessage>;

enum class DriveBag { kRos1, kMcap, kMcapWithoutChunks, kDb3 };

/// Poses and clouds in bags of every kind.
class BagPoses : public testing::TestWithParam<DriveBag> {
 protected:
  static std::int64_t at(double scan) {
    return kDrive_ns + static_cast<std::int64_t>(std::llround(scan * 10.0)) * kStep_ns / 10;
  }

  static void add_cloud(Drive& drive, std::int64_t stamp_ns, const std::string& frame = "lidar") {
    drive.push_back({"/points", std::string(kPointCloud2), stamp_ns, [=](MessageEncoding encoding) {
                       CloudHead head;
                       head.stamp_ns = stamp_ns;
                       head.frame = frame;
                       head.height = head.width = 1;
                       head.fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}};
                       head.point_step_bytes = head.row_step_bytes = 12;
                       return format_cloud(head, std::string(12, '\0'), encoding);
                     }});
  }
  static void add_tf(Drive& drive, const StampedTransform& transform, const char* topic = "/tf") {
    drive.push_back(
        {topic, std::string(kTfMessage), transform.stamp_ns,
         [=](MessageEncoding encoding) { return format_tf_message({transform}, encoding); }});
  }
  /// A pose message; `child` of Odometry only, `length` of its quaternion.
  static void add_pose(Drive& drive, std::string_view type, std::int64_t stamp_ns, double x_m,
                       const std::string& child = "base", double length = 1.0,
                       const std::string& parent = "odom") {
    const std::string kind(type);
    drive.push_back({"/pose", kind, stamp_ns, [=](MessageEncoding encoding) {
                       MessageSink sink(encoding);
                       if (encoding == MessageEncoding::kRos1) sink.put(std::uint32_t{0});
                       sink.put(static_cast<std::uint32_t>(stamp_ns / 1'000'000'000));
                       sink.put(static_cast<std::uint32_t>(stamp_ns % 1'000'000'000));
                       sink.put_text(parent);
                       if (kind == kOdometry) sink.put_text(child);
                       for (const double value : {x_m, 0.0, 0.0, 0.0, 0.0, 0.0, length}) {
                         sink.put(value);
                       }
                       if (kind == kOdometry) {
                         for (int i = 0; i < 36 + 6 + 36; ++i) sink.put(0.0);
                       }
                       return std::move(sink).bytes();
                     }});
  }

  /// Twelve scans, and what `make` adds at every one.
  static Drive drive_of(const std::function<void(Drive&, std::int64_t, double)>& make) {
    Drive drive;
    for (int k = 0; k < 12; ++k) {
      add_cloud(drive, at(k));
      make(drive, at(k), k);
    }
    return drive;
  }

  std::filesystem::path write(const Drive& drive, const std::string& name = "s") const {
    if (GetParam() == DriveBag::kRos1) return write_ros1(drive, name);
    if (GetParam() == DriveBag::kDb3) return write_db3(drive, name);
    McapBytes bag;
    bag.in_chunks = GetParam() == DriveBag::kMcap;
    bag.chunks.emplace_back();
    for (const DriveMessage& message : drive) {
      const std::size_t channel = place_of(bag.channels, message);
      if (channel == bag.channels.size()) {
        bag.channels.push_back({message.topic, ros2_type(message.type)});
      }
      bag.chunks[0].push_back({static_cast<std::uint16_t>(channel), message.recorded_ns,
                               packed(message.bytes(MessageEncoding::kCdr))});
    }
    return folder_.write(name + ".mcap", bag.str());
  }

  BagSequence open(const Drive& drive, const Reading& asked = {}) const {
    return {"s", write(drive), asked};
  }
  std::string error_of(const Drive& drive, const Reading& asked = {}) const {
    return message_of<DataError>([&] { open(drive, asked); });
  }
  static std::vector<double> xs_of(const Sequence& sequence) {
    std::vector<double> xs_m;
    for (std::size_t k = 0; k < sequence.size(); ++k) {
      xs_m.push_back(sequence.read(k).map_from_sensor.translation().x());
      EXPECT_EQ(xs_m.back(), sequence.map_from_sensor(k).translation().x());
    }
    return xs_m;
  }

  TempFolder folder_;
  bool packs_messages_ = false;

 private:
  template <typename Channels>
  static std::size_t place_of(const Channels& channels, const DriveMessage& message) {
    std::size_t place = 0;
    while (place < channels.size() && channels[place].topic != message.topic) ++place;
    return place;
  }
  std::string packed(std::string bytes) const {
    return packs_messages_ ? compress_zstd(bytes) : bytes;
  }
  std::filesystem::path write_ros1(const Drive& drive, const std::string& name) const {
    BagBytes bag;
    bag.chunks.emplace_back();
    for (const DriveMessage& message : drive) {
      std::size_t connection = 0;
      while (connection < bag.connections.size() &&
             bag.connections[connection].first != message.topic) {
        ++connection;
      }
      if (connection == bag.connections.size()) {
        bag.connections.emplace_back(message.topic, message.type);
      }
      bag.chunks[0].push_back({static_cast<std::uint32_t>(connection), message.recorded_ns,
                               message.bytes(MessageEncoding::kRos1)});
    }
    return folder_.write(name + ".bag", bag.str());
  }
  std::filesystem::path write_db3(const Drive& drive, const std::string& name) const {
    const auto writer = Ros2BagWriter::open(Ros2Storage::kSqlite, folder_ / ("of_" + name),
                                            packs_messages_ ? "zstd" : "none");
    for (const DriveMessage& message : drive) {
      writer->write(message.topic, message.recorded_ns, message.type,
                    message.bytes(MessageEncoding::kCdr));
    }
    writer->close();
    std::filesystem::rename(folder_ / ("of_" + name) / "bag_0.db3", folder_ / (name + ".db3"));
    std::filesystem::remove_all(folder_ / ("of_" + name));
    return folder_ / (name + ".db3");
  }
};

}  // namespace mosbench
