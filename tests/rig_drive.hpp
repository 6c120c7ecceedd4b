#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <string>
#include <vector>

#include "datasets/formats/pose_file.hpp"
#include "tests/bag_bytes.hpp"
#include "tests/odometry_scenes.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {

/// A vehicle with two LiDARs 2 m apart that drives through a street in which a box moves, as a bag
/// and as folders.
struct RigDrive {
  std::size_t scans = 12;
  double later_s = 0.03;  ///< the second LiDAR's scans
  double speed_m_s = 5;
  bool has_tf_static = true;  ///< else mounts are repeated in /tf
  bool timed = false;         ///< points are measured within 0.1 s, and say when
  std::vector<Pose> mounts = {pose_at({1, 0, 0}, 0), pose_at({-1, 0, 0}, 1.5)};  ///< on the vehicle
  std::vector<std::string> frames = {"lidar_a", "lidar_b"};  ///< those with a mount in the bag

  struct Scan {
    std::int64_t stamp_ns;
    SceneScan scene;
    std::vector<std::uint32_t> labels;
  };

  static std::int64_t ns_of(double s) { return std::llround(1e9 * (1000 + s)); }
  double seconds(std::size_t lidar, std::size_t k) const {
    return 0.1 * static_cast<double>(k) + (lidar == 0 ? 0 : later_s);
  }
  Pose vehicle_at(double s) const { return pose_at({speed_m_s * s, 0, 0}, 0); }
  Pose pose_of(std::size_t lidar, double s) const { return vehicle_at(s) * mounts[lidar]; }
  /// The box that moves.
  static SceneBox box_at(double s) { return {{9 - 4 * s, 2, -1.7}, {12 - 4 * s, 4, 0.5}}; }
  static bool is_in(const SceneBox& box, const Eigen::Vector3d& p, double margin_m) {
    return ((p - box.low).array() >= -margin_m).all() &&
           ((box.high - p).array() >= -margin_m).all();
  }

  Scan scan(std::size_t lidar, std::size_t k) const {
    const double s = seconds(lidar, k);
    const Pose pose = pose_of(lidar, s);
    std::vector<SceneBox> scene = street();
    scene.push_back(box_at(s));
    SceneSensor sensor{.seed = static_cast<unsigned>(10 * k + lidar), .rings = 24, .columns = 240};
    if (timed) {
      sensor.motion_m = pose.linear().transpose() * Eigen::Vector3d(0.1 * speed_m_s, 0, 0);
    }
    Scan scan{ns_of(s), scene_scan(scene, pose, sensor), {}};
    for (std::size_t i = 0; i < scan.scene.points.size(); ++i) {
      const Point& p = scan.scene.points[i];
      const double share = static_cast<double>(scan.scene.point_times_ns[i]) * 1e-8;
      // The scene gives points from where the sensor is at their time.
      const Eigen::Vector3d at = pose * (Eigen::Vector3d(p.x, p.y, p.z) + share * sensor.motion_m);
      scan.labels.push_back(is_in(box_at(s), at, 0.01) ? 251 : 9);
    }
    return scan;
  }

  std::string cloud(std::size_t lidar, const Scan& scan) const {
    CloudHead head;
    head.stamp_ns = scan.stamp_ns;
    head.frame = frames[lidar];
    head.height = 1;
    head.width = static_cast<std::uint32_t>(scan.labels.size());
    head.fields = {{"x", 0, 7, 1},          {"y", 4, 7, 1},      {"z", 8, 7, 1},
                   {"intensity", 12, 7, 1}, {"label", 16, 6, 1}, {timed ? "t" : "ring", 20, 6, 1}};
    head.point_step_bytes = 24;
    head.row_step_bytes = 24 * head.width;
    ByteSink records;
    for (std::size_t i = 0; i < scan.labels.size(); ++i) {
      records.put(scan.scene.points[i]);
      records.put(scan.labels[i]);
      records.put(timed ? static_cast<std::uint32_t>(scan.scene.point_times_ns[i]) : 0U);
    }
    return format_cloud(head, std::move(records).bytes());
  }

  /// A bag with the topics /a and /b; `mounted` LiDARs have a mount in /tf_static.
  std::string bag(std::size_t mounted = 2) const {
    BagBytes bag;
    bag.connections = {{"/a", std::string(kPointCloud2)},
                       {"/b", std::string(kPointCloud2)},
                       {"/tf", std::string(kTfMessage)},
                       {"/tf_static", std::string(kTfMessage)}};
    const auto mounts_at = [&](std::int64_t stamp_ns) {
      std::vector<StampedTransform> all;
      for (std::size_t i = 0; i < mounted; ++i) {
        all.push_back({stamp_ns, "base", frames[i], mounts[i]});
      }
      return all;
    };
    bag.chunks.push_back({});
    if (has_tf_static) bag.chunks.back().push_back({3, ns_of(-1), format_tf_message(mounts_at(0))});
    for (int i = -20; i < static_cast<int>(5 * scans) + 30; ++i) {
      const std::int64_t at_ns = ns_of(0.02 * i);
      auto transforms = has_tf_static ? std::vector<StampedTransform>{} : mounts_at(at_ns);
      transforms.push_back({at_ns, "map", "base", vehicle_at(0.02 * i)});
      bag.chunks.back().push_back({2, at_ns, format_tf_message(transforms)});
    }
    for (std::size_t k = 0; k < scans; ++k) {
      for (std::size_t lidar = 0; lidar < 2; ++lidar) {
        const Scan one = scan(lidar, k);
        bag.chunks.push_back(
            {{static_cast<std::uint32_t>(lidar), one.stamp_ns, cloud(lidar, one)}});
      }
    }
    return bag.str();
  }

  /// Folders a and b beside mounts.txt, a with poses.
  void write_folders(const TempFolder& folder, const std::string& name) const {
    std::string rows;
    std::vector<Pose> poses;
    for (std::size_t lidar = 0; lidar < 2; ++lidar) {
      const std::string own = name + (lidar == 0 ? "/a/" : "/b/");
      const Eigen::Vector3d at = mounts[lidar].translation();
      const Eigen::Quaterniond turn(mounts[lidar].linear());
      rows += fmt::format("{} {} {} {} {} {} {} {}\n", lidar == 0 ? "a" : "b", at.x(), at.y(),
                          at.z(), turn.x(), turn.y(), turn.z(), turn.w());
      std::string times;
      for (std::size_t k = 0; k < scans; ++k) {
        const Scan one = scan(lidar, k);
        if (lidar == 0) poses.push_back(pose_of(0, seconds(0, k)));
        times += fmt::format("{:.9f}\n", static_cast<double>(one.stamp_ns - ns_of(-5)) * 1e-9);
        const auto bytes_of = [](const auto& values) {
          return std::string_view(reinterpret_cast<const char*>(values.data()),
                                  values.size() * sizeof(values[0]));
        };
        folder.write(own + fmt::format("{:06}.bin", k), bytes_of(one.scene.points));
        folder.write(own + fmt::format("labels/{:06}.label", k), bytes_of(one.labels));
      }
      folder.write(own + "times.txt", times);
    }
    folder.write(name + "/mounts.txt", rows);
    write_poses(folder / (name + "/a/poses.txt"), poses);
  }
};

}  // namespace mosbench
