#include "datasets/rosbag/ros_messages.hpp"

#include <fmt/format.h>

#include "datasets/files/byte_cursor.hpp"
#include "datasets/files/quaternion.hpp"

namespace mosbench {
namespace {

constexpr std::uint64_t kNsPerSecond = 1'000'000'000;
constexpr std::uint64_t kMostPoints = 1ULL << 31U;

struct Header {
  std::int64_t stamp_ns = 0;
  std::string frame;
};

std::string without_slash(std::string_view frame) {
  if (frame.starts_with('/')) frame.remove_prefix(1);
  return std::string(frame);
}

Header take_header(ByteCursor& cursor) {
  cursor.take<std::uint32_t>();  // seq
  const std::uint64_t seconds = cursor.take<std::uint32_t>();
  const std::uint64_t nanoseconds = cursor.take<std::uint32_t>();
  return {static_cast<std::int64_t>(seconds * kNsPerSecond + nanoseconds),
          without_slash(cursor.take_counted())};
}

void put_header(ByteSink& sink, std::int64_t stamp_ns, const std::string& frame) {
  const auto stamp = static_cast<std::uint64_t>(stamp_ns);
  sink.put(std::uint32_t{0});
  sink.put(static_cast<std::uint32_t>(stamp / kNsPerSecond));
  sink.put(static_cast<std::uint32_t>(stamp % kNsPerSecond));
  sink.put_counted(frame);
}

StampedTransform take_transform(ByteCursor& cursor, const std::filesystem::path& file) {
  StampedTransform transform;
  const Header header = take_header(cursor);
  transform.stamp_ns = header.stamp_ns;
  transform.parent = header.frame;
  transform.child = without_slash(cursor.take_counted());
  Eigen::Vector3d translation_m;
  for (int axis = 0; axis < 3; ++axis) translation_m[axis] = cursor.take<double>();
  Eigen::Vector4d xyzw;
  for (int i = 0; i < 4; ++i) xyzw[i] = cursor.take<double>();
  const auto pose = pose_of(translation_m, xyzw);
  if (!pose) {
    throw DataError(file,
                    "the transform from " + transform.child + " to " + transform.parent +
                        " is not finite or its quaternion not of length 1",
                    "a rigid motion");
  }
  transform.parent_from_child = *pose;
  return transform;
}

void put_transform(ByteSink& sink, const StampedTransform& transform) {
  put_header(sink, transform.stamp_ns, transform.parent);
  sink.put_counted(transform.child);
  for (int axis = 0; axis < 3; ++axis) {
    sink.put(transform.parent_from_child.translation()[axis]);
  }
  const Eigen::Quaterniond q(transform.parent_from_child.linear());
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) sink.put(value);
}

}  // namespace

StampedTransform parse_transform(std::string_view bytes, const std::filesystem::path& file) {
  ByteCursor cursor(bytes, file, "a TransformStamped");
  return take_transform(cursor, file);
}

std::vector<StampedTransform> parse_tf_message(std::string_view bytes,
                                               const std::filesystem::path& file) {
  ByteCursor cursor(bytes, file, "a TFMessage");
  std::vector<StampedTransform> transforms;
  for (auto left = cursor.take<std::uint32_t>(); left > 0; --left) {
    transforms.push_back(take_transform(cursor, file));
  }
  return transforms;
}

std::string format_tf_message(const std::vector<StampedTransform>& transforms) {
  ByteSink sink;
  sink.put(static_cast<std::uint32_t>(transforms.size()));
  for (const StampedTransform& transform : transforms) put_transform(sink, transform);
  return std::move(sink).bytes();
}

CloudHead parse_cloud_head(std::string_view bytes, const std::filesystem::path& file) {
  ByteCursor cursor(bytes, file, "a PointCloud2");
  CloudHead head;
  const Header header = take_header(cursor);
  head.stamp_ns = header.stamp_ns;
  head.frame = header.frame;
  head.height = cursor.take<std::uint32_t>();
  head.width = cursor.take<std::uint32_t>();
  for (auto left = cursor.take<std::uint32_t>(); left > 0; --left) {
    CloudField& field = head.fields.emplace_back();
    field.name = cursor.take_counted();
    field.offset_bytes = cursor.take<std::uint32_t>();
    field.datatype = cursor.take<std::uint8_t>();
    field.count = cursor.take<std::uint32_t>();
  }
  head.big_endian = cursor.take<std::uint8_t>() != 0;
  head.point_step_bytes = cursor.take<std::uint32_t>();
  head.row_step_bytes = cursor.take<std::uint32_t>();
  head.records_bytes = cursor.take<std::uint32_t>();
  head.records_at_bytes = bytes.size() - cursor.rest().size();
  const bool fits = head.points() <= kMostPoints &&
                    std::uint64_t{head.width} * head.point_step_bytes <= head.row_step_bytes &&
                    std::uint64_t{head.row_step_bytes} * head.height == head.records_bytes;
  if (!fits && head.points() != 0) {
    throw DataError(file,
                    fmt::format("a PointCloud2 of {} x {} points of {} bytes, {} bytes a row, has "
                                "{} bytes",
                                head.width, head.height, head.point_step_bytes, head.row_step_bytes,
                                head.records_bytes),
                    "height rows of at least width points");
  }
  return head;
}

std::string format_cloud(const CloudHead& head, std::string_view records) {
  ByteSink sink;
  put_header(sink, head.stamp_ns, head.frame);
  sink.put(head.height);
  sink.put(head.width);
  sink.put(static_cast<std::uint32_t>(head.fields.size()));
  for (const CloudField& field : head.fields) {
    sink.put_counted(field.name);
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

}  // namespace mosbench
