#include "datasets/rosbag/ros_messages.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::uint64_t kMostPoints = 1ULL << 31U;

struct Header {
  std::int64_t stamp_ns = 0;
  std::string frame;
};

std::string without_slash(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return std::string(frame);
}

/// Seconds count from 0 to 2^32 in ROS 1, and have a sign in ROS 2.
std::int64_t take_stamp_ns(MessageCursor& cursor) {
  const auto bits = cursor.take<std::uint32_t>();
  const std::int64_t seconds =
      cursor.is_cdr() ? std::int64_t{static_cast<std::int32_t>(bits)} : std::int64_t{bits};
  return seconds * kNsPerSecond + cursor.take<std::uint32_t>();
}

Header take_header(MessageCursor& cursor) {
  if (!cursor.is_cdr()) cursor.take<std::uint32_t>();  // seq
  const std::int64_t stamp_ns = take_stamp_ns(cursor);
  return {stamp_ns, without_slash(cursor.take_text())};
}

void put_header(MessageSink& sink, std::int64_t stamp_ns, const std::string& frame) {
  const auto stamp = static_cast<std::uint64_t>(stamp_ns);
  if (!sink.is_cdr()) sink.put(std::uint32_t{0});
  sink.put(static_cast<std::uint32_t>(stamp / kNsPerSecond));
  sink.put(static_cast<std::uint32_t>(stamp % kNsPerSecond));
  sink.put_text(frame);
}

/// Reads a position and a quaternion; nothing where tf2 would ignore them.
std::optional<Pose> take_pose(MessageCursor& cursor) {
  Eigen::Vector3d translation_m;
  for (int axis = 0; axis < 3; ++axis) translation_m[axis] = cursor.take<double>();
  Eigen::Vector4d xyzw;
  for (int i = 0; i < 4; ++i) xyzw[i] = cursor.take<double>();
  // tf2 takes squares of the length within 0.01 of 1.
  constexpr double kTolerance = 0.005;
  return pose_of(translation_m, xyzw, kTolerance);
}

/// Reads a transform between two frames, or a pose, whose frames may be empty.
StampedTransform take_transform(MessageCursor& cursor, bool names_child, bool is_pose) {
  const Header header = take_header(cursor);
  StampedTransform transform{header.stamp_ns, header.frame, "", Pose::Identity()};
  if (names_child) transform.child = without_slash(cursor.take_text());
  const std::optional<Pose> pose = take_pose(cursor);
  if (pose) transform.parent_from_child = *pose;
  const bool has_frames = !transform.parent.empty() && !transform.child.empty();
  const bool is_of_itself = has_frames && transform.parent == transform.child;
  transform.is_sound = pose && !is_of_itself && (has_frames || is_pose);
  return transform;
}

void put_transform(MessageSink& sink, const StampedTransform& transform) {
  put_header(sink, transform.stamp_ns, transform.parent);
  sink.put_text(transform.child);
  for (int axis = 0; axis < 3; ++axis) {
    sink.put(transform.parent_from_child.translation()[axis]);
  }
  const Eigen::Quaterniond q(transform.parent_from_child.linear());
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) sink.put(value);
}

/// Returns how far apart rows begin. Many drivers write row_step wrongly (0, the width, that of
/// another message) or append bytes: where it does not fit, rows follow one another, as PCL and
/// ROS's own Python reader take them. Throws DataError when the bytes are too few for the points.
std::uint32_t fitting_row_step_bytes(const CloudHead& head, const std::filesystem::path& file) {
  const std::uint64_t row_bytes = std::uint64_t{head.width} * head.point_step_bytes;
  const bool fits = head.points() <= kMostPoints && row_bytes * head.height <= head.records_bytes;
  if (!fits && head.points() != 0) {
    throw DataError(file,
                    fmt::format("a PointCloud2 of {} x {} points of {} bytes, {} bytes a row, has "
                                "{} bytes",
                                head.width, head.height, head.point_step_bytes, head.row_step_bytes,
                                head.records_bytes),
                    "all its points");
  }
  const bool is_padded = head.row_step_bytes > row_bytes &&
                         std::uint64_t{head.row_step_bytes} * head.height <= head.records_bytes;
  return is_padded ? head.row_step_bytes : static_cast<std::uint32_t>(row_bytes);
}

/// Some drivers leave a height or width of 0: what the bytes hold are the points.
void count_points(CloudHead& head) {
  if (head.points() > 0 || head.point_step_bytes == 0) return;
  if (head.records_bytes < head.point_step_bytes) return;
  head.height = 1;
  head.width = head.records_bytes / head.point_step_bytes;
}

/// The points of a CustomMsg are records of 19 bytes, which CDR begins at multiples of 4.
CloudHead parse_livox_head(MessageCursor& cursor) {
  constexpr std::uint8_t kUint8 = 2, kUint32 = 6, kFloat32 = 7;
  constexpr std::uint32_t kPointBytes = 19;
  CloudHead head;
  const Header header = take_header(cursor);
  head.stamp_ns = header.stamp_ns;
  head.frame = header.frame;
  cursor.take<std::uint64_t>();                             // timebase
  cursor.take<std::uint32_t>();                             // point_num
  for (int i = 0; i < 4; ++i) cursor.take<std::uint8_t>();  // lidar_id, rsvd
  head.height = 1;
  head.width = cursor.take<std::uint32_t>();
  head.fields = {{"offset_time", 0, kUint32, 1},
                 {"x", 4, kFloat32, 1},
                 {"y", 8, kFloat32, 1},
                 {"z", 12, kFloat32, 1},
                 {"intensity", 16, kUint8, 1}};
  head.big_endian = cursor.is_big_endian();
  head.point_step_bytes = cursor.is_cdr() ? kPointBytes + 1 : kPointBytes;
  const std::uint64_t all_bytes = std::uint64_t{head.width} * head.point_step_bytes;
  // No padding follows the last point; more than fits is refused as points that are missing.
  const std::uint64_t records_bytes = all_bytes - (cursor.is_cdr() && all_bytes > 0 ? 1 : 0);
  head.records_bytes =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(records_bytes, UINT32_MAX));
  head.row_step_bytes = head.records_bytes;
  head.records_at_bytes = cursor.position_bytes();
  return head;
}

std::optional<std::vector<std::uint32_t>> read_labels(const CloudHead& head,
                                                      std::string_view message,
                                                      const std::filesystem::path& file) {
  const CloudField* field = find_field(head, "label");
  if (field == nullptr) return std::nullopt;
  std::vector<std::uint32_t> labels;
  labels.reserve(head.points());
  for (const std::int64_t label : integers_of(head, *field, message, file)) {
    labels.push_back(static_cast<std::uint32_t>(label));
  }
  return labels;
}

}  // namespace

std::vector<StampedTransform> parse_transforms(std::string_view bytes, const MessageFormat& format,
                                               const std::filesystem::path& file) {
  const auto name = std::string(format.type.substr(format.type.find('/') + 1));
  MessageCursor cursor(bytes, format.encoding, file, "a " + name);
  const bool is_path = format.type == kPath, is_odometry = format.type == kOdometry;
  const bool is_pose = is_path || is_odometry || format.type == kPoseStamped ||
                       format.type == kPoseWithCovarianceStamped;
  const bool names_child = !is_pose || is_odometry;
  if (is_path) take_header(cursor);
  const bool is_list = is_path || format.type == kTfMessage || format.type == kOldTfMessage;
  std::vector<StampedTransform> transforms;
  for (auto left = is_list ? cursor.take<std::uint32_t>() : 1; left > 0; --left) {
    transforms.push_back(take_transform(cursor, names_child, is_pose));
  }
  return transforms;
}

std::string format_tf_message(const std::vector<StampedTransform>& transforms,
                              MessageEncoding encoding) {
  MessageSink sink(encoding);
  sink.put(static_cast<std::uint32_t>(transforms.size()));
  for (const StampedTransform& transform : transforms) put_transform(sink, transform);
  return std::move(sink).bytes();
}

CloudHead parse_cloud_head(std::string_view bytes, const std::filesystem::path& file,
                           const MessageFormat& format) {
  if (std::ranges::find(kLivoxMessages, format.type) != kLivoxMessages.end()) {
    MessageCursor points(bytes, format.encoding, file, "a CustomMsg");
    return parse_livox_head(points);
  }
  MessageCursor cursor(bytes, format.encoding, file, "a PointCloud2");
  CloudHead head;
  const Header header = take_header(cursor);
  head.stamp_ns = header.stamp_ns;
  head.frame = header.frame;
  head.height = cursor.take<std::uint32_t>();
  head.width = cursor.take<std::uint32_t>();
  for (auto left = cursor.take<std::uint32_t>(); left > 0; --left) {
    CloudField& field = head.fields.emplace_back();
    field.name = cursor.take_text();
    field.offset_bytes = cursor.take<std::uint32_t>();
    field.datatype = cursor.take<std::uint8_t>();
    field.count = cursor.take<std::uint32_t>();
  }
  head.big_endian = cursor.take<std::uint8_t>() != 0;
  head.point_step_bytes = cursor.take<std::uint32_t>();
  head.row_step_bytes = cursor.take<std::uint32_t>();
  head.records_bytes = cursor.take<std::uint32_t>();
  head.records_at_bytes = cursor.position_bytes();
  count_points(head);
  head.row_step_bytes = fitting_row_step_bytes(head, file);
  return head;
}

std::string format_cloud(const CloudHead& head, std::string_view records,
                         MessageEncoding encoding) {
  MessageSink sink(encoding);
  put_header(sink, head.stamp_ns, head.frame);
  sink.put(head.height);
  sink.put(head.width);
  sink.put(static_cast<std::uint32_t>(head.fields.size()));
  for (const CloudField& field : head.fields) {
    sink.put_text(field.name);
    sink.put(field.offset_bytes);
    sink.put(field.datatype);
    sink.put(field.count);
  }
  sink.put(static_cast<std::uint8_t>(head.big_endian));
  sink.put(head.point_step_bytes);
  sink.put(head.row_step_bytes);
  sink.put_counted(records);
  sink.put(std::uint8_t{1});  // is_dense
  return std::move(sink).bytes();
}

bool has_times(const CloudHead& head) { return find_time_field(head) != nullptr; }

TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file,
                       const MessageFormat& format, bool timed) {
  const CloudHead head = parse_cloud_head(message, file, format);
  if (message.size() - head.records_at_bytes < head.records_bytes) {
    throw DataError(file, "a PointCloud2 ends within its points",
                    std::to_string(head.records_bytes) + " bytes of them");
  }
  TimedCloud cloud;
  cloud.stamp_ns = head.stamp_ns;
  if (find_field(head, "label") != nullptr) cloud.labels.emplace();
  if (head.points() == 0) return cloud;
  cloud.points = points_of(head, message, file);
  if (timed) cloud.times = times_of(head, message, file);
  cloud.labels = read_labels(head, message, file);
  return cloud;
}

std::string parse_string(std::string_view bytes, const MessageFormat& format,
                         const std::filesystem::path& file) {
  MessageCursor cursor(bytes, format.encoding, file, "a String");
  return std::string(cursor.take_text());
}

std::string format_string(std::string_view text, MessageEncoding encoding) {
  MessageSink sink(encoding);
  sink.put_text(text);
  return std::move(sink).bytes();
}

std::string message_definition(std::string_view type, MessageEncoding encoding) {
  if (type == kString) return "string data\n";
  const bool is_ros1 = encoding == MessageEncoding::kRos1;
  // ROS 1 leaves out the package of Header, and of types in the same one.
  const std::string header = is_ros1 ? "Header" : "std_msgs/Header";
  const std::string sensor = is_ros1 ? "" : "sensor_msgs/",
                    geometry = is_ros1 ? "" : "geometry_msgs/";
  const std::string rule = (is_ros1 ? "\n" : "") + std::string(80, '=') + "\n";
  const std::string header_definition =
      is_ros1 ? "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
              : "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + rule +
                    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
  if (type == kPointCloud2) {
    return header + " header\nuint32 height\nuint32 width\n" + sensor +
           "PointField[] fields\nbool is_bigendian\nuint32 point_step\nuint32 row_step\n"
           "uint8[] data\nbool is_dense\n" +
           rule + header_definition + rule +
           "MSG: sensor_msgs/PointField\nuint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\n"
           "uint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
           "string name\nuint32 offset\nuint8 datatype\nuint32 count\n";
  }
  return "geometry_msgs/TransformStamped[] transforms\n" + rule +
         "MSG: geometry_msgs/TransformStamped\n" + header + " header\nstring child_frame_id\n" +
         geometry + "Transform transform\n" + rule + header_definition + rule +
         "MSG: geometry_msgs/Transform\n" + geometry + "Vector3 translation\n" + geometry +
         "Quaternion rotation\n" + rule +
         "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + rule +
         "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
}

}  // namespace mosbench
