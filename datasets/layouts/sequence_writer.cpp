#include "datasets/layouts/sequence_writer.hpp"

#include <span>
#include <vector>

#include "datasets/files/bin_file.hpp"
#include "datasets/files/byte_cursor.hpp"
#include "datasets/files/calib_file.hpp"
#include "datasets/files/indices_file.hpp"
#include "datasets/files/label_file.hpp"
#include "datasets/files/pose_file.hpp"
#include "datasets/files/times_file.hpp"
#include "datasets/rosbag/bag_writer.hpp"
#include "datasets/rosbag/ros_messages.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

class KittiWriter : public SequenceWriter {
 public:
  explicit KittiWriter(const fs::path& folder) : folder_(folder) {}

  void add(const Frame& frame) override {
    write_bin(folder_ / "velodyne" / (frame.stem + ".bin"), frame.points);
    if (frame.truth) write_labels(folder_ / "labels" / (frame.stem + ".label"), *frame.truth);
    if (frame.stamp_ns) stamps_ns_.push_back(*frame.stamp_ns);
    poses_.push_back(frame.map_from_sensor);
  }

  void finish() override {
    if (stamps_ns_.size() == poses_.size()) write_times(folder_ / "times.txt", stamps_ns_);
    write_calib(folder_ / "calib.txt", Pose::Identity());
    write_poses(folder_ / "poses.txt", poses_);
  }

 private:
  fs::path folder_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<Pose> poses_;
};

bool is_moving(std::uint32_t label) {
  const std::uint32_t id = label & 0xFFFFU;
  return id >= kMovingLabel && id <= 259U;
}

/// Stamps and truth as DOALS has them.
class DoalsRows {
 public:
  /// The frame's stamp.
  std::int64_t add(const Frame& frame) {
    constexpr std::int64_t kPeriodNs = 100'000'000;
    stamps_ns_.push_back(
        frame.stamp_ns.value_or(static_cast<std::int64_t>(stamps_ns_.size()) * kPeriodNs));
    if (!frame.truth) return stamps_ns_.back();
    IndicesRow& row = rows_.emplace_back();
    row.stamp_ns = stamps_ns_.back();
    for (std::uint32_t i = 0; i < frame.truth->size(); ++i) {
      if (is_moving((*frame.truth)[i])) row.moving.push_back(i);
    }
    return row.stamp_ns;
  }
  const std::vector<std::int64_t>& stamps_ns() const { return stamps_ns_; }
  void write(const fs::path& folder) const {
    if (!rows_.empty()) write_indices(folder / "indices.csv", rows_);
  }

 private:
  std::vector<std::int64_t> stamps_ns_;
  std::vector<IndicesRow> rows_;
};

class DoalsWriter : public SequenceWriter {
 public:
  explicit DoalsWriter(const fs::path& folder) : folder_(folder) {}

  void add(const Frame& frame) override {
    write_bin(folder_ / "velodyne" / (frame.stem + ".bin"), frame.points);
    rows_.add(frame);
    poses_.push_back(frame.map_from_sensor);
  }

  void finish() override {
    rows_.write(folder_);
    write_times(folder_ / "times.txt", rows_.stamps_ns());
    write_poses(folder_ / "poses.txt", poses_);
  }

 private:
  fs::path folder_;
  DoalsRows rows_;
  std::vector<Pose> poses_;
};

constexpr const char* kLidarFrame = "os1_lidar";

/// x y z intensity float32 and t uint32, as far as DOALS's driver has the same; a scan is taken at
/// one instant, so every t is 0.
std::string cloud_message(std::span<const Point> points, std::int64_t stamp_ns) {
  constexpr std::uint32_t kStepBytes = 20;
  constexpr std::uint8_t kUint32 = 6, kFloat32 = 7;
  CloudHead head;
  head.stamp_ns = stamp_ns;
  head.frame = kLidarFrame;
  head.height = 1;
  head.width = static_cast<std::uint32_t>(points.size());
  head.fields = {{"x", 0, kFloat32, 1},
                 {"y", 4, kFloat32, 1},
                 {"z", 8, kFloat32, 1},
                 {"intensity", 12, kFloat32, 1},
                 {"t", 16, kUint32, 1}};
  head.point_step_bytes = kStepBytes;
  head.row_step_bytes = kStepBytes * head.width;
  ByteSink records;
  for (const Point& point : points) {
    records.put(point);
    records.put(std::uint32_t{0});
  }
  return format_cloud(head, std::move(records).bytes());
}

class DoalsBagWriter : public SequenceWriter {
 public:
  DoalsBagWriter(const fs::path& folder, const std::string& compression)
      : folder_(folder), bag_(folder / "bag.bag", compression) {}

  void add(const Frame& frame) override {
    const std::int64_t stamp_ns = rows_.add(frame);
    bag_.write("/tf", stamp_ns, kTfMessage,
               format_tf_message({{stamp_ns, "map", kLidarFrame, frame.map_from_sensor}}));
    bag_.write("/os1_cloud_node/points", stamp_ns, kPointCloud2,
               cloud_message(frame.points, stamp_ns));
  }

  void finish() override {
    rows_.write(folder_);
    bag_.close();
  }

 private:
  fs::path folder_;
  BagWriter bag_;
  DoalsRows rows_;
};

}  // namespace

std::unique_ptr<SequenceWriter> write_as_kitti(const fs::path& folder) {
  return std::make_unique<KittiWriter>(folder);
}

std::unique_ptr<SequenceWriter> write_as_doals(const fs::path& folder) {
  return std::make_unique<DoalsWriter>(folder);
}

std::unique_ptr<SequenceWriter> write_as_doals_bag(const fs::path& folder,
                                                   const std::string& compression) {
  return std::make_unique<DoalsBagWriter>(folder, compression);
}

}  // namespace mosbench
