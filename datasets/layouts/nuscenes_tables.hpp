#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

namespace mosbench {

/// An annotated object that moves.
struct NuscenesBox {
  Pose map_from_box = Pose::Identity();  ///< x along the length, y the width, z the height
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();
  std::uint32_t instance = 0;  ///< of its object within the scene; 0 where that is not known
};

/// The token of an object that `convert` writes, which says its instance.
std::string nuscenes_object_token(std::uint32_t instance);

struct NuscenesScan {
  std::filesystem::path file;  ///< from the root of the data set
  std::int64_t stamp_ns = 0;
  Pose map_from_sensor = Pose::Identity();
  bool is_key_frame = false;
  std::vector<NuscenesBox> moving;  ///< of key frames
};

struct NuscenesScene {
  std::string name;
  std::vector<NuscenesScan> scans;  ///< of LIDAR_TOP, by time
};

/// What the tables of a version ("v1.0-mini") say of LIDAR_TOP.
struct NuscenesTables {
  std::vector<NuscenesScene> scenes;
  bool has_annotations = false;  ///< false for v1.0-test, whose table of them is empty
};

/// The tables that are always read; attribute.json only where there is sample_annotation.json.
inline constexpr std::array<const char*, 6> kNuscenesTables = {
    "scene.json",   "sample.json", "sample_data.json", "sensor.json", "calibrated_sensor.json",
    "ego_pose.json"};

/// Returns those of them that a folder lacks.
std::vector<std::string> missing_nuscenes_tables(const std::filesystem::path& folder);

/// Returns the names of the scenes in their order, reading scene.json only. Throws DataError.
std::vector<std::string> nuscenes_scene_names(const std::filesystem::path& tables);

/// Reads the tables, row by row; as long as a caller keeps the result, others get the same. Throws
/// DataError, also for a scan without pose.
std::shared_ptr<const NuscenesTables> read_nuscenes_tables(const std::filesystem::path& tables);

/// Returns 251 for the points within a box, its sides included, with its instance in the upper 16
/// bits, and 9 for all others.
std::vector<std::uint32_t> nuscenes_truth(std::span<const Point> points,
                                          const Pose& map_from_sensor,
                                          std::span<const NuscenesBox> moving);

}  // namespace mosbench
