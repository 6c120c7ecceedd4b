#pragma once

#include <string>
#include <string_view>

namespace mosbench {

/// Returns the definition of sensor_msgs/msg/PointCloud2 or tf2_msgs/msg/TFMessage with the types
/// that it is made of, as MCAP keeps it for other programs.
std::string ros2_definition(std::string_view type);

}  // namespace mosbench
