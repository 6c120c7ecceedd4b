#include "datasets/layouts/nuscenes_writer.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "datasets/files/byte_cursor.hpp"
#include "datasets/files/disk_sync.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/layouts/folder_search.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kTables = "v1.0-mini";
constexpr std::array kNames = {"attribute", "calibrated_sensor", "sample", "sample_annotation",
                               "scene",     "sample_data",       "sensor", "ego_pose"};
constexpr const char* kMovingToken = "vehicle.moving";
constexpr double kBox_m = 2e-5;

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
    row.map_from_sensor = frame.map_from_sensor;
    write_file_atomic(folder_ / scan_file(row.stem, row.is_key_frame), five_columns(frame.points));
    if (!frame.truth) return;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const Point& p = frame.points[i];
      if (is_moving((*frame.truth)[i])) row.moving.emplace_back(p.x, p.y, p.z);
    }
  }

  void finish() override {
    expect_rising_stamps();
    write_table("sensor",
                ordered_json::array(
                    {{{"token", "lidar"}, {"channel", "LIDAR_TOP"}, {"modality", "lidar"}}}));
    ordered_json mount = row_of_pose("mount", ego_from_sensor());
    mount["sensor_token"] = "lidar";
    write_table("calibrated_sensor", ordered_json::array({mount}));
    write_table("attribute", {{{"token", kMovingToken}, {"name", kMovingToken}}});
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
    std::vector<Eigen::Vector3d> moving;  ///< points, in the sensor's frame
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

  void write_table(const char* name, const ordered_json& rows) const {
    write_file_atomic(folder_ / kTables / (std::string(name) + ".json"), rows.dump(0) + "\n");
  }

  bool is_sample(std::size_t k) const { return scans_[k].is_key_frame || k == 0; }

  void write_samples() const {
    const std::string scene = token_of(0);
    ordered_json samples = ordered_json::array();
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      if (!is_sample(k)) continue;
      samples.push_back(
          {{"token", token_of(k)}, {"timestamp", scans_[k].stamp_us}, {"scene_token", scene}});
    }
    write_table("sample", samples);
    write_table("scene", {{{"token", scene},
                           {"name", folder_name(folder_)},
                           {"nbr_samples", samples.size()},
                           {"first_sample_token", token_of(0)}}});
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
    ordered_json rows = ordered_json::array();
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      const Row& scan = scans_[k];
      if (!scan.is_key_frame) continue;
      rows.push_back(annotation(k, scan.map_from_sensor, 0.0));
      for (const Eigen::Vector3d& point : scan.moving) {
        Pose map_from_box = Pose::Identity();
        map_from_box.translation() = scan.map_from_sensor * point;
        rows.push_back(annotation(k, map_from_box, kBox_m));
        rows.back()["attribute_tokens"].push_back(kMovingToken);
      }
    }
    write_table("sample_annotation", rows);
  }

  void write_scans() const {
    ordered_json rows = ordered_json::array();
    std::size_t sample = 0;
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      const Row& scan = scans_[k];
      if (is_sample(k)) sample = k;
      rows.push_back({{"token", token_of(k)},
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
    write_table("sample_data", rows);
  }

  void write_poses() const {
    ordered_json rows = ordered_json::array();
    const Pose sensor_from_ego = ego_from_sensor().inverse();
    for (std::size_t k = 0; k < scans_.size(); ++k) {
      rows.push_back(row_of_pose(token_of(k), scans_[k].map_from_sensor * sensor_from_ego));
      rows.back()["timestamp"] = scans_[k].stamp_us;
    }
    sync_file_system_of(folder_);
    commit_file(folder_ / kNuscenesLastFile, rows.dump(0) + "\n");
  }

  fs::path folder_;
  std::vector<Row> scans_;
};

}  // namespace

std::vector<fs::path> nuscenes_table_files() {
  std::vector<fs::path> files;
  for (const char* name : kNames)
    files.push_back(fs::path(kTables) / (std::string(name) + ".json"));
  return files;
}

std::vector<fs::path> nuscenes_scan_files(const std::string& stem) {
  return {scan_file(stem, true), scan_file(stem, false)};
}

std::unique_ptr<SequenceWriter> write_as_nuscenes(const fs::path& folder,
                                                  const WriteOptions& options) {
  return std::make_unique<NuscenesWriter>(folder, options);
}

}  // namespace mosbench
