#pragma once

#include <filesystem>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// Returns the matrix "Tr:" of a KITTI calibration, camera_from_lidar; other lines are ignored.
/// Throws DataError when there is none, two, or one that is no rigid motion.
Pose parse_calib(std::string_view text, const std::filesystem::path& file);
/// Formats P0 to P3 as identity, then Tr.
std::string format_calib(const Pose& camera_from_lidar);

/// Returns whether a pose is the identity to the last bit, as is Tr of data sets whose poses are
/// the LiDAR's.
bool is_identity(const Pose& pose);

/// Turns a pose of poses.txt, which KITTI stores as map_from_camera, into the LiDAR's: Tr^-1 * P *
/// Tr. Returns the pose unchanged, bit for bit, when Tr is the identity.
Pose lidar_pose(const Pose& pose, const Pose& camera_from_lidar);

Pose read_calib(const std::filesystem::path& file);
void write_calib(const std::filesystem::path& file, const Pose& camera_from_lidar);

}  // namespace mosbench
