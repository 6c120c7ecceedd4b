#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/files/point_records.hpp"

namespace mosbench {

/// The message types that are read; messages of other types are skipped.
inline constexpr std::string_view kPointCloud2 = "sensor_msgs/PointCloud2";
inline constexpr std::string_view kTfMessage = "tf2_msgs/TFMessage";
inline constexpr std::string_view kOldTfMessage = "tf/tfMessage";
inline constexpr std::string_view kTransformStamped = "geometry_msgs/TransformStamped";

/// A transform of a tf tree: parent_from_child at one instant.
struct StampedTransform {
  std::int64_t stamp_ns = 0;
  std::string parent;  ///< frames without a leading slash
  std::string child;
  Pose parent_from_child = Pose::Identity();
};

/// Parse messages as ROS 1 serializes them. Throw DataError naming `file` for bytes that are cut
/// off, numbers that are not finite, and a quaternion that is not of length 1.
StampedTransform parse_transform(std::string_view bytes, const std::filesystem::path& file);
std::vector<StampedTransform> parse_tf_message(std::string_view bytes,
                                               const std::filesystem::path& file);
std::string format_tf_message(const std::vector<StampedTransform>& transforms);

/// Parses a message up to its points; no more of it has to be given. Throws DataError also when the
/// sizes contradict each other.
CloudHead parse_cloud_head(std::string_view bytes, const std::filesystem::path& file);
std::string format_cloud(const CloudHead& head, std::string_view records);

}  // namespace mosbench
