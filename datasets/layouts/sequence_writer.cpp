#include "datasets/layouts/sequence_writer.hpp"

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/rosbag/bag_writer.hpp"
#include "datasets/rosbag/ros2_bag.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Writes poses.txt, by which a sequence can be opened, when all else is on the disk.
void write_poses_last(const fs::path& folder, const std::vector<Pose>& poses) {
  sync_file_system_of(folder);
  commit_file(folder / "poses.txt", format_poses(poses));
}

class KittiWriter : public SequenceWriter {
 public:
  KittiWriter(const fs::path& folder, const WriteOptions& options)
      : folder_(folder),
        camera_from_lidar_(options.camera_from_lidar),
        stamps_ns_(options.scans),
        poses_(options.scans, Pose::Identity()) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    write_bin(folder_ / "velodyne" / (frame.stem + ".bin"), frame.points);
    if (frame.truth) write_labels(folder_ / "labels" / (frame.stem + ".label"), *frame.truth);
    stamps_ns_[scan_index] = frame.stamp_ns;
    poses_[scan_index] = frame.map_from_sensor;
  }

  void finish() override {
    std::vector<std::int64_t> times_ns;
    for (const auto& stamp_ns : stamps_ns_) {
      if (stamp_ns) times_ns.push_back(*stamp_ns);
    }
    if (times_ns.size() == poses_.size()) write_times(folder_ / "times.txt", times_ns);
    write_file_atomic(folder_ / "calib.txt", format_calib(camera_from_lidar_));
    write_poses_last(folder_, poses_);
  }

 private:
  fs::path folder_;
  Pose camera_from_lidar_;
  std::vector<std::optional<std::int64_t>> stamps_ns_;
  std::vector<Pose> poses_;
};

/// Refuses scans that a bag, which is ordered by stamps and finds poses by them, would give back in
/// another order or with the pose of another.
class RisingStamps {
 public:
  explicit RisingStamps(fs::path file) : file_(std::move(file)) {}

  void expect_later(std::int64_t stamp_ns, const Frame& frame) {
    if (last_ns_ && stamp_ns <= *last_ns_) {
      throw DataError(file_, "scan " + frame.stem + " is not later than the one before it",
                      "stamps that increase, by which a bag orders its scans");
    }
    last_ns_ = stamp_ns;
  }

 private:
  fs::path file_;
  std::optional<std::int64_t> last_ns_;
};

/// Collects stamps and truth as DOALS stores them.
class DoalsRows {
 public:
  explicit DoalsRows(std::size_t scans) : stamps_ns_(scans), rows_(scans) {}

  /// Returns the frame's stamp.
  std::int64_t add(std::size_t scan_index, const Frame& frame) {
    const std::int64_t stamp_ns = stamp_or_period_ns(scan_index, frame.stamp_ns);
    stamps_ns_[scan_index] = stamp_ns;
    if (!frame.truth) return stamp_ns;
    IndicesRow& row = rows_[scan_index].emplace();
    row.stamp_ns = stamp_ns;
    for (std::uint32_t i = 0; i < frame.truth->size(); ++i) {
      if (is_moving((*frame.truth)[i])) row.moving.push_back(i);
    }
    return stamp_ns;
  }
  const std::vector<std::int64_t>& stamps_ns() const { return stamps_ns_; }
  void write(const fs::path& folder) const {
    std::vector<IndicesRow> labelled;
    for (const auto& row : rows_) {
      if (row) labelled.push_back(*row);
    }
    if (!labelled.empty()) write_file_atomic(folder / "indices.csv", format_indices(labelled));
  }

 private:
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::optional<IndicesRow>> rows_;  ///< of the labelled scans
};

class DoalsWriter : public SequenceWriter {
 public:
  DoalsWriter(const fs::path& folder, std::size_t scans)
      : folder_(folder), rows_(scans), poses_(scans, Pose::Identity()) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    write_bin(folder_ / "velodyne" / (frame.stem + ".bin"), frame.points);
    rows_.add(scan_index, frame);
    poses_[scan_index] = frame.map_from_sensor;
  }

  void finish() override {
    rows_.write(folder_);
    write_times(folder_ / "times.txt", rows_.stamps_ns());
    write_poses_last(folder_, poses_);
  }

 private:
  fs::path folder_;
  DoalsRows rows_;
  std::vector<Pose> poses_;
};

constexpr const char* kDoalsFrame = "os1_lidar";

/// A field of uint32 beside x y z intensity, with one value per point.
struct ExtraField {
  std::string name;
  std::vector<std::uint32_t> values;
};

/// Returns a message with x y z intensity float32 and the extra field, if there is one.
std::string cloud_message(std::span<const Point> points, std::int64_t stamp_ns,
                          const std::string& frame, const std::optional<ExtraField>& extra,
                          MessageEncoding encoding) {
  constexpr std::uint8_t kUint32 = 6, kFloat32 = 7;
  CloudHead head;
  head.stamp_ns = stamp_ns;
  head.frame = frame;
  head.height = 1;
  head.width = static_cast<std::uint32_t>(points.size());
  head.fields = {{"x", 0, kFloat32, 1},
                 {"y", 4, kFloat32, 1},
                 {"z", 8, kFloat32, 1},
                 {"intensity", 12, kFloat32, 1}};
  if (extra) head.fields.push_back({extra->name, sizeof(Point), kUint32, 1});
  head.point_step_bytes = sizeof(Point) + (extra ? sizeof(std::uint32_t) : 0);
  head.row_step_bytes = head.point_step_bytes * head.width;
  ByteSink records;
  for (std::size_t i = 0; i < points.size(); ++i) {
    records.put(points[i]);
    if (extra) records.put(extra->values[i]);
  }
  return format_cloud(head, std::move(records).bytes(), encoding);
}

class DoalsBagWriter : public SequenceWriter {
 public:
  DoalsBagWriter(const fs::path& folder, const WriteOptions& options)
      : folder_(folder),
        bag_(folder / "bag.bag", options.compression),
        mark_(options.mark),
        rows_(options.scans),
        stamps_(folder / "bag.bag") {}

  void write(std::size_t scan_index, const Frame& frame) override {
    const std::int64_t stamp_ns = rows_.add(scan_index, frame);
    stamps_.expect_later(stamp_ns, frame);
    if (const std::string mark = std::exchange(mark_, ""); !mark.empty()) {
      bag_.write(kMarkTopic, stamp_ns, kString, format_string(mark, MessageEncoding::kRos1));
    }
    bag_.write("/tf", stamp_ns, kTfMessage,
               format_tf_message({{stamp_ns, "map", kDoalsFrame, frame.map_from_sensor}}));
    // The field of times that DOALS's driver has, too: a scan is taken at one instant.
    const ExtraField times{"t", std::vector<std::uint32_t>(frame.points.size(), 0)};
    bag_.write("/os1_cloud_node/points", stamp_ns, kPointCloud2,
               cloud_message(frame.points, stamp_ns, kDoalsFrame, times, MessageEncoding::kRos1));
  }

  void finish() override {
    rows_.write(folder_);
    bag_.close();
  }

 private:
  fs::path folder_;
  BagWriter bag_;
  std::string mark_;  ///< until it is written
  DoalsRows rows_;
  RisingStamps stamps_;
};

Ros2Storage storage_of(const WriteOptions& options) {
  if (options.bag == BagKind::kMcap) return Ros2Storage::kMcap;
  if (options.bag == BagKind::kDb3) return Ros2Storage::kSqlite;
  throw UsageError("a recording is written as a ROS 2 bag, expected ros2-mcap or ros2-db3");
}

class Ros2SequenceWriter : public SequenceWriter {
 public:
  Ros2SequenceWriter(const fs::path& folder, const WriteOptions& options)
      : bag_(Ros2BagWriter::open(storage_of(options), folder, options.compression)),
        mark_(options.mark),
        stamps_(folder / message_file_of(storage_of(options))) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    constexpr const char* kFrame = "lidar";
    constexpr MessageEncoding kEncoding = MessageEncoding::kCdr;
    const std::int64_t stamp_ns = stamp_or_period_ns(scan_index, frame.stamp_ns);
    stamps_.expect_later(stamp_ns, frame);
    if (const std::string mark = std::exchange(mark_, ""); !mark.empty()) {
      bag_->write(kMarkTopic, stamp_ns, kString, format_string(mark, kEncoding));
    }
    bag_->write("/tf", stamp_ns, kTfMessage,
                format_tf_message({{stamp_ns, "map", kFrame, frame.map_from_sensor}}, kEncoding));
    std::optional<ExtraField> labels;
    if (frame.truth) labels = {"label", *frame.truth};
    bag_->write("/points", stamp_ns, kPointCloud2,
                cloud_message(frame.points, stamp_ns, kFrame, labels, kEncoding));
  }

  void finish() override { bag_->close(); }

 private:
  std::unique_ptr<Ros2BagWriter> bag_;
  std::string mark_;  ///< until it is written
  RisingStamps stamps_;
};

}  // namespace

std::string_view to_string(BagKind kind) {
  constexpr std::array<std::string_view, 4> kNames = {"none", "ros1", "mcap", "db3"};
  return kNames[static_cast<std::size_t>(kind)];
}

bool is_moving(std::uint32_t label) {
  const std::uint32_t id = label & 0xFFFFU;
  return id >= kMovingLabel && id <= 259U;
}

std::int64_t stamp_or_period_ns(std::size_t scan_index, std::optional<std::int64_t> stamp_ns) {
  constexpr std::int64_t kPeriodNs = 100'000'000;
  return stamp_ns.value_or(static_cast<std::int64_t>(scan_index) * kPeriodNs);
}

const char* last_file_of(const WriteOptions& options) {
  if (options.bag == BagKind::kNone) return "poses.txt";
  return options.bag == BagKind::kRos1 ? "bag.bag" : message_file_of(storage_of(options));
}

std::vector<fs::path> files_of_kitti(const Sequence& sequence) {
  std::vector<fs::path> files = {"times.txt", "calib.txt"};
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    files.push_back(fs::path("velodyne") / (sequence.stem(k) + ".bin"));
    files.push_back(fs::path("labels") / (sequence.stem(k) + ".label"));
  }
  return files;
}

std::vector<fs::path> files_of_doals(const Sequence& sequence) {
  std::vector<fs::path> files = {"times.txt", "indices.csv"};
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    files.push_back(fs::path("velodyne") / (sequence.stem(k) + ".bin"));
  }
  return files;
}

std::vector<fs::path> files_of_ros2_bag(const Sequence&) { return {kBagMetadataFile}; }

std::unique_ptr<SequenceWriter> write_as_ros2_bag(const fs::path& folder,
                                                  const WriteOptions& options) {
  return std::make_unique<Ros2SequenceWriter>(folder, options);
}

std::unique_ptr<SequenceWriter> write_as_kitti(const fs::path& folder,
                                               const WriteOptions& options) {
  return std::make_unique<KittiWriter>(folder, options);
}

std::unique_ptr<SequenceWriter> write_as_doals(const fs::path& folder,
                                               const WriteOptions& options) {
  if (options.bag != BagKind::kNone) return std::make_unique<DoalsBagWriter>(folder, options);
  return std::make_unique<DoalsWriter>(folder, options.scans);
}

}  // namespace mosbench
