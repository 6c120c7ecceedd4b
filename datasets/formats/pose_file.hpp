#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// Deviation from length 1 that rounding in a text file can cause.
inline constexpr double kQuaternionTolerance = 1e-3;

/// Returns the pose of a translation and a quaternion (x y z w), which is normalized; nothing when
/// a number is not finite or the quaternion is not of length 1.
inline std::optional<Pose> pose_of(const Eigen::Vector3d& translation_m,
                                   const Eigen::Vector4d& xyzw,
                                   double tolerance = kQuaternionTolerance) {
  if (!translation_m.allFinite() || !(std::abs(xyzw.norm() - 1.0) <= tolerance)) {
    return std::nullopt;
  }
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(xyzw).normalized().toRotationMatrix();
  pose.translation() = translation_m;
  return pose;
}

/// Largest element of |R^T R - I| that counts as a rotation. Files with 6 significant digits stay
/// below 1e-5 and chains of float32 products below 1e-4; a wrong column order or a scale is far
/// above.
inline constexpr double kRotationTolerance = 1e-3;
bool is_rotation(const Eigen::Matrix3d& matrix);

/// No recording reaches farther from its first pose: a quarter of the Earth's circumference.
inline constexpr double kFarthestPose_m = 1e7;
double distance_m(const Pose& from, const Pose& to);

/// Parses poses in KITTI's form: a row-major 3x4 matrix in 12 numbers per line, metres, kept bit
/// for bit as parsed to double. Throws DataError with the line for another count of numbers, text,
/// numbers that are not finite, a rotation part that is no rotation, and a pose that is farther
/// than kFarthestPose_m from the first.
std::vector<Pose> parse_poses(std::string_view text, const std::filesystem::path& file);
/// Formats with the shortest decimals that read back as the same doubles.
std::string format_poses(std::span<const Pose> poses);

/// Parses one row of 12 numbers, or of 16 with 0 0 0 1 at the end; `line` (from 1) is for the
/// error.
Pose parse_pose_row(std::string_view row, const std::filesystem::path& file, std::size_t line);
std::string format_pose_row(const Pose& pose);

std::vector<Pose> read_poses(const std::filesystem::path& file);
void write_poses(const std::filesystem::path& file, std::span<const Pose> poses);

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

/// The formats of pose files.
enum class PoseFormat : std::uint8_t {
  kKitti,   ///< rows of 12 numbers
  kTum,     ///< "stamp_s tx ty tz qx qy qz qw", separated by blanks; lines with # are comments
  kRollout  ///< "tx,ty,tz,qx,qy,qz,qw" of Dynablox's drift simulation, sensor_from_map
};

inline constexpr std::array<std::string_view, 3> kPoseFormatNames = {"kitti", "tum", "dynablox"};

std::string_view to_string(PoseFormat format);
/// Returns nothing when the name is not one of kitti, tum, dynablox.
std::optional<PoseFormat> pose_format_from_string(std::string_view name);

/// The poses of a file, unchanged.
struct PoseList {
  PoseFormat format = PoseFormat::kKitti;
  std::vector<Pose> poses;
  std::vector<std::int64_t> stamps_ns;  ///< one per pose, increasing; of kTum only
  std::size_t repeated = 0;             ///< rows that were dropped: the row before has their stamp
  std::size_t unknown = 0;              ///< rows of kTum that were dropped: they hold NaN
  std::int64_t rounding_ns = 1'000;  ///< what printing the stamps can have changed, at least 1 us

  /// Returns what is odd about the rows, or nothing.
  std::vector<std::string> remarks(const std::filesystem::path& file) const;
};

/// Recognises the format from the first row when it is not given. Blanks, commas or semicolons
/// separate numbers, a first row may hold names. Throws DataError with the line.
PoseList parse_pose_list(std::string_view text, std::optional<PoseFormat> format,
                         const std::filesystem::path& file);
PoseList read_pose_list(const std::filesystem::path& file, std::optional<PoseFormat> format);

}  // namespace mosbench
