#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "datasets/files/pose_list.hpp"

namespace mosbench {

/// The sensor that the poses of a file belong to.
enum class PoseFrame : std::uint8_t {
  kByCalib,  ///< KITTI rows: the camera's when calib.txt holds a Tr other than the identity, else
             ///< the lidar's; other formats: the lidar's
  kLidar,
  kCamera  ///< the camera of Tr in calib.txt
};

/// What the user specified about how a sequence is to be read.
struct ReadingOptions {
  /// A pose file to use instead of the sequence's own.
  std::optional<std::filesystem::path> poses = std::nullopt;
  /// Read no poses: every scan gets the identity, for `PosedSequence` to put others in their place.
  bool poses_by_odometry = false;
  std::optional<PoseFormat> pose_format = std::nullopt;  ///< recognised when not set
  PoseFrame pose_frame = PoseFrame::kByCalib;
  /// Whether the poses are sensor_from_map; when not set, only those of PoseFormat::kRollout are.
  std::optional<bool> poses_inverse = std::nullopt;
  std::optional<std::string> topic = std::nullopt;      ///< of a bag's PointCloud2
  std::optional<std::string> map_frame = std::nullopt;  ///< of a bag's tf tree
  bool undistort = true;                                ///< scans of a bag whose points have times
  std::size_t bin_columns = 4;                          ///< float32 per point in .bin files
};

/// How a sequence was read, for results: (what, how) in a fixed order.
using ReadingStatement = std::vector<std::pair<std::string, std::string>>;

}  // namespace mosbench
