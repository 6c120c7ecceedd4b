#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/formats/pose_list.hpp"

namespace mosbench {

/// The sensor that the poses of a file belong to.
enum class PoseFrame : std::uint8_t {
  kByCalib,  ///< KITTI rows: the camera's when calib.txt holds a Tr other than the identity and no
             ///< mark beside the file says otherwise, else the lidar's; other formats: the lidar's
  kLidar,
  kCamera  ///< the camera of Tr in calib.txt
};

/// The motion of the sensor by which scans are corrected whose points have times.
enum class Deskew : std::uint8_t {
  kNone,
  kVelocity,  ///< that since the scan before
  kPoses      ///< that between the poses around each point
};

/// Where the times of points come from when the scans do not say.
enum class PointTimes : std::uint8_t {
  kColumn,  ///< the fifth float32 of each point in .bin files, seconds after the scan's stamp; a
            ///< field of .pcd and .ply files, see `times_after_stamp_ns`
  kAzimuth  ///< the direction of each point, as the sensor of KITTI turns
};

/// What the user specified about how a sequence is to be read.
struct ReadingOptions {
  /// A pose file to use instead of the sequence's own, or a folder with one per sequence.
  std::optional<std::filesystem::path> poses = std::nullopt;
  /// Read no poses: every scan gets the identity, for `PosedSequence` to put others in their place.
  bool poses_by_odometry = false;
  std::optional<PoseFormat> pose_format = std::nullopt;  ///< recognised when not set
  PoseFrame pose_frame = PoseFrame::kByCalib;
  /// Whether the poses are sensor_from_map; when not set, only those of PoseFormat::kRollout are.
  std::optional<bool> poses_inverse = std::nullopt;
  /// Scans between stamped poses farther apart than this are left out.
  double max_pose_gap_s = 0.5;
  std::optional<std::string> topic = std::nullopt;      ///< of a bag's PointCloud2
  std::optional<std::string> map_frame = std::nullopt;  ///< of a bag's tf tree
  /// Of a bag's poses; searched when not set.
  std::optional<std::string> pose_topic = std::nullopt;
  /// When not set: by the poses, except that odometry registers scans as its own setting says.
  std::optional<Deskew> deskew = std::nullopt;
  std::optional<PointTimes> point_times = std::nullopt;  ///< when not set, those of a bag's points
  /// Of truth that is a flow: from which speed on a point moves; when not set, 0.5.
  std::optional<double> moving_speed_m_s = std::nullopt;
  /// float32 per point in .bin files; when not set 4, and scans that clearly have others are
  /// refused.
  std::optional<std::size_t> bin_columns = std::nullopt;
  /// Whether points of KITTI's HDL-64E are raised by the angle that its calibration misses.
  bool hdl64_correction = false;
  /// Disturbances of what is read, as `parse_perturbation` takes them.
  std::optional<std::string> perturb = std::nullopt;

  /// Whether points with times are to be moved.
  bool undistorts() const { return deskew != Deskew::kNone; }
};

/// How a sequence was read, for results: (what, how) in a fixed order.
using ReadingStatement = std::vector<std::pair<std::string, std::string>>;

}  // namespace mosbench
