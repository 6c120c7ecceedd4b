#pragma once

#include <cstdint>
#include <string_view>

namespace mosbench {

/// How the numbers of a message follow one another.
enum class MessageEncoding : std::uint8_t {
  kRos1,         ///< packed, little endian
  kCdr,          ///< OMG's CDR, as ROS 2 writes it: aligned, a byte order said in four bytes before
  kCdrBigEndian  ///< the same; only writers have to tell it from kCdr
};

/// The message types that are read; messages of other types are skipped.
inline constexpr std::string_view kPointCloud2 = "sensor_msgs/PointCloud2";
inline constexpr std::string_view kLivoxCustomMsg = "livox_ros_driver2/CustomMsg";
inline constexpr std::string_view kOldLivoxCustomMsg = "livox_ros_driver/CustomMsg";
inline constexpr std::string_view kTfMessage = "tf2_msgs/TFMessage";
inline constexpr std::string_view kOldTfMessage = "tf/tfMessage";
inline constexpr std::string_view kTransformStamped = "geometry_msgs/TransformStamped";
inline constexpr std::string_view kOdometry = "nav_msgs/Odometry";
inline constexpr std::string_view kPoseStamped = "geometry_msgs/PoseStamped";
inline constexpr std::string_view kPath = "nav_msgs/Path";

/// What a message is and how it is encoded.
struct MessageFormat {
  std::string_view type = kPointCloud2;
  MessageEncoding encoding = MessageEncoding::kRos1;
};

}  // namespace mosbench
