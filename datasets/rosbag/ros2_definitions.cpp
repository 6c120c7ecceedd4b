#include "datasets/rosbag/ros2_definitions.hpp"

namespace mosbench {
namespace {

constexpr const char* kHeaderDefinition =
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
constexpr const char* kTimeDefinition = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

std::string joined(std::initializer_list<const char*> definitions) {
  std::string text;
  for (const char* definition : definitions) {
    if (!text.empty()) text.append(80, '=').push_back('\n');
    text += definition;
  }
  return text;
}

}  // namespace

std::string ros2_definition(std::string_view type) {
  if (type == "sensor_msgs/msg/PointCloud2") {
    return joined(
        {"std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
         "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
         kHeaderDefinition, kTimeDefinition,
         "MSG: sensor_msgs/PointField\nuint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\n"
         "uint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
         "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"});
  }
  return joined({"geometry_msgs/TransformStamped[] transforms\n",
                 "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\n"
                 "string child_frame_id\ngeometry_msgs/Transform transform\n",
                 kHeaderDefinition, kTimeDefinition,
                 "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n"
                 "geometry_msgs/Quaternion rotation\n",
                 "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n",
                 "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"});
}

}  // namespace mosbench
