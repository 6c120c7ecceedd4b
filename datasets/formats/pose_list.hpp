#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace mosbench {

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
};

/// Recognises the format from the first row when it is not given. Throws DataError with the line.
PoseList parse_pose_list(std::string_view text, std::optional<PoseFormat> format,
                         const std::filesystem::path& file);
PoseList read_pose_list(const std::filesystem::path& file, std::optional<PoseFormat> format);

}  // namespace mosbench
