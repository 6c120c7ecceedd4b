#pragma once

#include <string>
#include <string_view>

namespace mosbench {

/// Turns the ROS 2 name of a type, "sensor_msgs/msg/PointCloud2", into that of ROS 1,
/// "sensor_msgs/PointCloud2".
inline std::string ros1_type(std::string_view name) {
  constexpr std::string_view kMiddle = "/msg/";
  const std::size_t middle = name.find(kMiddle);
  if (middle == std::string_view::npos) return std::string(name);
  return std::string(name.substr(0, middle)) + '/' +
         std::string(name.substr(middle + kMiddle.size()));
}

/// The inverse, for types of ROS 1.
inline std::string ros2_type(std::string_view name) {
  const std::size_t slash = name.find('/');
  return std::string(name.substr(0, slash)) + "/msg" + std::string(name.substr(slash));
}

}  // namespace mosbench
