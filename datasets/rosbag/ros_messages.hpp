#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
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
  std::string child;   ///< empty for a pose, whose message names no child; it may have no parent
  Pose parent_from_child = Pose::Identity();
  bool is_sound = true;  ///< else tf2 ignores it: not finite, no rotation, or without frames
};

/// Returns the transforms of a TFMessage, a TransformStamped, an Odometry, a PoseStamped, one with
/// covariance, or a Path.
/// Throws DataError naming `file` for bytes that are cut off.
std::vector<StampedTransform> parse_transforms(std::string_view bytes, const MessageFormat& format,
                                               const std::filesystem::path& file);
std::string format_tf_message(const std::vector<StampedTransform>& transforms,
                              MessageEncoding encoding = MessageEncoding::kRos1);

/// The text of a kString. Throws as `parse_transforms`.
std::string parse_string(std::string_view bytes, const MessageFormat& format,
                         const std::filesystem::path& file);
std::string format_string(std::string_view text, MessageEncoding encoding);

/// Parses a PointCloud2 or a CustomMsg of Livox up to its points; no more of it has to be given.
/// The points of Livox become records with the fields x, y, z, intensity, offset_time. Throws
/// DataError also when the sizes contradict each other.
CloudHead parse_cloud_head(std::string_view bytes, const std::filesystem::path& file,
                           const MessageFormat& format = {});
std::string format_cloud(const CloudHead& head, std::string_view records,
                         MessageEncoding encoding = MessageEncoding::kRos1);

/// The points of a PointCloud2 or of a CustomMsg of Livox in the order of its records, none
/// dropped.
struct TimedCloud {
  std::int64_t stamp_ns = 0;
  std::vector<Point> points;
  /// When each point was measured, as the field of `find_time_field` holds it; empty without one.
  std::vector<double> times;
  std::optional<std::vector<std::uint32_t>> labels;  ///< field "label"
};

/// Parses a whole message. Fields may have any offset and any numeric type; intensity is 0 when
/// there is none. Throws DataError when x, y or z is missing or no single number, or a field lies
/// beyond the point. Reads times if they are wanted.
TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file,
                       const MessageFormat& format = {}, bool timed = true);

/// Returns whether `head` names a field that `parse_cloud` reads times from.
bool has_times(const CloudHead& head);

/// Returns the definition of kPointCloud2, kTfMessage or kString with the types that it is made of,
/// as bags keep it for other programs.
std::string message_definition(std::string_view type, MessageEncoding encoding);

}  // namespace mosbench
