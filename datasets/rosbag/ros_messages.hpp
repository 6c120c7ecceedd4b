#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/point_records.hpp"
#include "datasets/rosbag/message_format.hpp"

namespace mosbench {

/// A transform of a tf tree: parent_from_child at one instant.
struct StampedTransform {
  std::int64_t stamp_ns = 0;
  std::string parent;  ///< frames without a leading slash
  std::string child;   ///< empty for a pose, whose message names no child
  Pose parent_from_child = Pose::Identity();
};

/// Returns the transforms of a TFMessage, a TransformStamped, an Odometry, a PoseStamped or a Path.
/// Throws DataError naming `file` for bytes that are cut off, numbers that are not finite, and a
/// quaternion that is not of length 1.
std::vector<StampedTransform> parse_transforms(std::string_view bytes, const MessageFormat& format,
                                               const std::filesystem::path& file);
/// The same for what ROS 1 writes.
std::vector<StampedTransform> parse_tf_message(std::string_view bytes,
                                               const std::filesystem::path& file);
std::string format_tf_message(const std::vector<StampedTransform>& transforms,
                              MessageEncoding encoding = MessageEncoding::kRos1);

/// Parses a PointCloud2 or a CustomMsg of Livox up to its points; no more of it has to be given.
/// The points of Livox become records with the fields x, y, z, intensity, offset_time. Throws
/// DataError also when the sizes contradict each other.
CloudHead parse_cloud_head(std::string_view bytes, const std::filesystem::path& file,
                           const MessageFormat& format = {});
std::string format_cloud(const CloudHead& head, std::string_view records,
                         MessageEncoding encoding = MessageEncoding::kRos1);

}  // namespace mosbench
