#pragma once

#include <filesystem>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// The matrix "Tr:" of a KITTI calibration, camera_from_lidar; other lines are not looked at.
/// Throws DataError when there is none, two, or one that is no rigid motion.
Pose parse_calib(std::string_view text, const std::filesystem::path& file);
/// P0 to P3 as identity, then Tr.
std::string format_calib(const Pose& camera_from_lidar);

/// Whether a pose is the identity to the last bit, as Tr of data sets whose poses are the lidar's.
bool is_identity(const Pose& pose);

/// KITTI stores map_from_camera in poses.txt; this is the lidar's pose, Tr^-1 * P * Tr. The pose
/// itself, bit for bit, when Tr is the identity.
Pose lidar_pose(const Pose& pose, const Pose& camera_from_lidar);

Pose read_calib(const std::filesystem::path& file);
void write_calib(const std::filesystem::path& file, const Pose& camera_from_lidar);

}  // namespace mosbench
