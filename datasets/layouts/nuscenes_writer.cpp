#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/nuscenes_tables.hpp"
#include "datasets/layouts/sequence_writer.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kTables = "v1.0-mini";
constexpr std::array kNames = {"attribute", "calibrated_sensor", "sample", "sample_annotation",
                               "scene",     "sample_data",       "sensor", "ego_pose"};
constexpr const char* kMovingToken = "vehicle.moving";
constexpr double kBox_m = 2e-5;
constexpr std::size_t kColumnsWritten = 5;

fs::path scan_file(const std::string& stem, bool is_key_frame) {
  return fs::path(is_key_frame ? "samples" : "sweeps") / "LIDAR_TOP" / (stem + ".pcd.bin");
}

/// How the LiDAR is mounted on nuScenes' cars, in round numbers: turned by 90 degrees to the right.
Pose ego_from_sensor() {
  Pose pose = Pose::Identity();
  pose.linear() << 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  pose.translation() << 0.94, 0.0, 1.84;
  return pose;
}

ordered_json row_of_pose(const std::string& token, const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d t = pose.translation();
  return {{"token", token},
          {"rotation", {q.w(), q.x(), q.y(), q.z()}},
          {"translation", {t.x(), t.y(), t.z()}}};
}

std::string token_of(std::size_t number) { return fmt::format("{:032x}", number + 1); }

/// x y z intensity and a ring, which is not known.
std::string five_columns(const std::vector<Point>& points) {
  ByteSink sink;
  for (const Point& point : points) {
    sink.put(point);
    sink.put(0.0F);
  }
  return std::move(sink).bytes();
}

/// A point that moves, and its object.
struct MovingPoint {
  std::uint32_t place = 0;
  std::uint16_t instance = 0;
};

std::vector<MovingPoint> moving_points(const Frame& frame) {
  std::vector<MovingPoint> moving;
  if (!frame.truth) return moving;
  for (std::uint32_t i = 0; i < frame.truth->size(); ++i) {
    const std::uint32_t label = (*frame.truth)[i];
    if (is_moving(label)) moving.push_back({i, static_cast<std::uint16_t>(label >> 16U)});
  }
  return moving;
}

/// A table that is written row by row: the annotations of a scene are far more than its scans.
class TableFile {
 public:
  explicit TableFile(fs::path file) : file_(std::move(file)) {
    write_by(file_, [&] {
      fs::create_directories(file_.parent_path());
      partial_.emplace(file_);
    });
  }

  void add(const ordered_json& row) {
    constexpr std::size_t kFull = 1 << 20;
    text_ += is_empty_ ? "[\n" : ",\n";
    is_empty_ = false;
    text_ += row.dump();
    if (text_.size() > kFull) flush();
  }

  void finish() {
    end();
    write_by(file_, [&] { partial_->put_in_place_of(file_); });
  }

  /// Waits until it is on the disk, too.
  void commit() {
    end();
    write_by(file_, [&] {
      partial_->sync();
      partial_->put_in_place_of(file_);
    });
    sync_names_of(file_.parent_path());
  }

 private:
  void end() {
    text_ += is_empty_ ? "[]\n" : "\n]\n";
    flush();
  }

  void flush() {
    write_by(file_, [&] { partial_->write(text_); });
    text_.clear();
  }

  fs::path file_;
  std::optional<PartialFile> partial_;
  std::string text_;
  bool is_empty_ = true;
};

class NuscenesWriter : public SequenceWriter {
 public:
  NuscenesWriter(fs::path folder, const WriteOptions& options)
      : folder_(std::move(folder)), scans_(options.scans) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    constexpr std::int64_t kPeriod_us = 50'000, kNsPerUs = 1000;
    Row& row = scans_[scan_index];
    row.stem = frame.stem;
    row.is_key_frame = frame.truth.has_value();
    row.stamp_us = frame.stamp_ns ? *frame.stamp_ns / kNsPerUs
                                  : static_cast<std::int64_t>(scan_index) * kPeriod_us;
    if (row.stamp_us < 0) {
      throw DataError(folder_, "scan " + frame.stem + " has a stamp below 0", "us since 1970");
    }
    row.map_from_sensor = frame.map_from_sensor;
    write_file_atomic(folder_ / scan_file(row.stem, row.is_key_frame), five_columns(frame.points));
    row.points = frame.points.size();
    row.moving = moving_points(frame);
  }

  void finish() override {
    expect_rising_stamps();
    write_row("sensor", {{"token", "lidar"}, {"channel", "LIDAR_TOP"}, {"modality", "lidar"}});
    ordered_json mount = row_of_pose("mount", ego_from_sensor());
    mount["sensor_token"] = "lidar";
    write_row("calibrated_sensor", mount);
    write_row("attribute", {{"token", kMovingToken}, {"name", kMovingToken}});
    write_samples();
    write_annotations();
    write_scans();
    write_poses();
  }

 private:
  struct Row {
    std::string stem;
    bool is_key_frame = false;
    std::int64_t stamp_us = 0;
    Pose map_from_sensor = Pose::Identity();
    std::size_t points = 0;
    std::vector<MovingPoint> moving;
  };

  /// nuScenes orders scans by their stamps.
  void expect_rising_stamps() const {
    for (std::size_t k = 1; k < scans_.size(); ++k) {
      if (scans_[k].stamp_us > scans_[k - 1].stamp_us) continue;
      throw DataError(folder_ / kTables / "sample_data.json",
                      "scan " + scans_[k].stem + " is not a microsecond later than the one before",
                      "stamps that increase");
    }
  }

  TableFile table(const char* name) const {
    return TableFile(folder_ / kTables / (std::string(name) + ".json"));
  }

  /// Writes a table of one row.
  void write_row(const char* name, const ordered_json& row) const {
    TableFile rows = table(name);
    rows.add(row);
    rows.finish();
  }

  bool is_sample(std::size_t k) const { return scans_[k].is_key_frame || k == 0; }

  void write_samples() const {
    const std::string scene = token_of(0);
    TableFile rows = table("sample");
    std::size_t samples = 0;
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      if (!is_sample(k)) continue;
      ++samples;
      rows.add({{"token", token_of(k)}, {"timestamp", scans_[k].stamp_us}, {"scene_token", scene}});
    }
    rows.finish();
    write_row("scene", {{"token", scene},
                        {"name", folder_name(folder_)},
                        {"nbr_samples", samples},
                        {"first_sample_token", token_of(0)}});
  }

  static ordered_json annotation(std::size_t k, const Pose& map_from_box, double size_m) {
    ordered_json row = row_of_pose(token_of(k), map_from_box);
    row["sample_token"] = token_of(k);
    row["size"] = {size_m, size_m, size_m};
    row["attribute_tokens"] = ordered_json::array();
    return row;
  }

  /// An object of no size and no attribute in each key frame says that it is annotated.
  void write_annotations() const {
    TableFile rows = table("sample_annotation");
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      if (!scans_[k].is_key_frame) continue;
      rows.add(annotation(k, scans_[k].map_from_sensor, 0.0));
      if (!scans_[k].moving.empty()) add_moving(k, rows);
    }
    rows.finish();
  }

  /// Points are read from their file again: those of all scans may not fit in memory.
  void add_moving(std::size_t k, TableFile& rows) const {
    const Row& scan = scans_[k];
    const fs::path file = folder_ / scan_file(scan.stem, true);
    const std::vector<Point> points = read_scan(file, kColumnsWritten);
    if (points.size() != scan.points) {
      throw DataError(file, fmt::format("has {} points now", points.size()),
                      fmt::format("the {} that were written", scan.points));
    }
    for (const MovingPoint& moving : scan.moving) {
      Pose map_from_box = Pose::Identity();
      map_from_box.translation() = scan.map_from_sensor * position_of(points[moving.place]);
      ordered_json row = annotation(k, map_from_box, kBox_m);
      if (moving.instance != 0) row["instance_token"] = nuscenes_object_token(moving.instance);
      row["attribute_tokens"].push_back(kMovingToken);
      rows.add(row);
    }
  }

  void write_scans() const {
    TableFile rows = table("sample_data");
    std::size_t sample = 0;
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      const Row& scan = scans_[k];
      if (is_sample(k)) sample = k;
      rows.add({{"token", token_of(k)},
                {"sample_token", token_of(sample)},
                {"ego_pose_token", token_of(k)},
                {"calibrated_sensor_token", "mount"},
                {"timestamp", scan.stamp_us},
                {"fileformat", "pcd"},
                {"is_key_frame", scan.is_key_frame},
                {"filename", scan_file(scan.stem, scan.is_key_frame).generic_string()},
                {"prev", k == 0 ? "" : token_of(k - 1)},
                {"next", k + 1 == scans_.size() ? "" : token_of(k + 1)}});
    }
    rows.finish();
  }

  void write_poses() const {
    sync_file_system_of(folder_);
    TableFile rows = table("ego_pose");
    const Pose sensor_from_ego = ego_from_sensor().inverse();
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      ordered_json row = row_of_pose(token_of(k), scans_[k].map_from_sensor * sensor_from_ego);
      row["timestamp"] = scans_[k].stamp_us;
      rows.add(row);
    }
    rows.commit();
  }

  fs::path folder_;
  std::vector<Row> scans_;
};

}  // namespace

std::vector<fs::path> files_of_nuscenes(const Sequence& sequence) {
  std::vector<fs::path> files;
  for (const char* name : kNames) {
    files.push_back(fs::path(kTables) / (std::string(name) + ".json"));
  }
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    for (const bool is_key_frame : {true, false}) {
      files.push_back(scan_file(sequence.stem(k), is_key_frame));
    }
  }
  return files;
}

std::unique_ptr<SequenceWriter> write_as_nuscenes(const fs::path& folder,
                                                  const WriteOptions& options) {
  return std::make_unique<NuscenesWriter>(folder, options);
}

}  // namespace mosbench
