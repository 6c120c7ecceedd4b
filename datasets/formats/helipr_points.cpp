#include "datasets/formats/helipr_points.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// The last scan whose points have no intensity.
constexpr std::int64_t kLastWithout_ns = 1'691'936'557'946'849'179;

constexpr std::uint8_t kUint8 = 2, kInt32 = 5, kUint32 = 6, kFloat32 = 7;
constexpr std::uint32_t kIntensityAt = 12, kVelocityAt = 16, kAevaIntensityAt = 25;

/// Where a point, which begins with x, y and z in float32, keeps the rest.
struct PointLayout {
  std::string_view name;
  std::uint32_t size_bytes;
  std::uint8_t intensity_type;
  std::uint32_t time_at_bytes;
  std::uint8_t time_type;
  double time_unit_s;
};
/// By HeliprSensor. What is left out: line of Aeva; tag and line of Avia; reflectivity, ring and
/// ambient of Ouster; ring of Velodyne.
constexpr std::array<PointLayout, 4> kLayouts = {{{"Aeva", 29, kFloat32, 20, kInt32, 1e-9},
                                                  {"Avia", 19, kUint8, 15, kUint32, 1e-9},
                                                  {"Ouster", 26, kFloat32, 16, kUint32, 1e-9},
                                                  {"Velodyne", 22, kFloat32, 18, kFloat32, 1.0}}};

const PointLayout& layout_of(HeliprSensor sensor) {
  return kLayouts[static_cast<std::size_t>(sensor)];
}

CloudHead head_of(HeliprSensor sensor, std::int64_t stamp_ns, std::size_t points) {
  const PointLayout& layout = layout_of(sensor);
  const bool is_at_end = sensor == HeliprSensor::kAeva && stamp_ns > kLastWithout_ns;
  CloudHead head;
  head.height = 1;
  head.width = static_cast<std::uint32_t>(points);
  head.point_step_bytes = static_cast<std::uint32_t>(helipr_point_bytes(sensor, stamp_ns));
  head.fields = {{"x", 0, kFloat32},
                 {"y", 4, kFloat32},
                 {"z", 8, kFloat32},
                 {"intensity", is_at_end ? kAevaIntensityAt : kIntensityAt, layout.intensity_type},
                 {"velocity", kVelocityAt, kFloat32},
                 {"time", layout.time_at_bytes, layout.time_type}};
  return head;
}

std::int64_t expect_within_second(double time_s, const std::filesystem::path& file,
                                  std::size_t point) {
  if (!(std::abs(time_s) <= 1.0)) {
    throw DataError(file, point, fmt::format("is measured {} s after the stamp", time_s),
                    "a time within a second");
  }
  return std::llround(time_s * 1e9);
}

}  // namespace

std::string_view to_string(HeliprSensor sensor) { return layout_of(sensor).name; }

std::optional<HeliprSensor> helipr_sensor_from_string(std::string_view name) {
  const auto found = std::ranges::find(kLayouts, name, &PointLayout::name);
  if (found == kLayouts.end()) return std::nullopt;
  return static_cast<HeliprSensor>(found - kLayouts.begin());
}

std::size_t helipr_point_bytes(HeliprSensor sensor, std::int64_t stamp_ns) {
  const bool lacks = sensor == HeliprSensor::kAeva && stamp_ns <= kLastWithout_ns;
  return layout_of(sensor).size_bytes - (lacks ? sizeof(float) : 0);
}

std::size_t helipr_point_count(std::uintmax_t size_bytes, HeliprSensor sensor,
                               std::int64_t stamp_ns, const std::filesystem::path& file) {
  const std::size_t point_bytes = helipr_point_bytes(sensor, stamp_ns);
  if (size_bytes % point_bytes == 0) return static_cast<std::size_t>(size_bytes) / point_bytes;
  throw DataError(file, fmt::format("{} bytes are no multiple of {}", size_bytes, point_bytes),
                  fmt::format("points of HeLiPR's {}", to_string(sensor)));
}

HeliprScan parse_helipr_scan(std::string_view bytes, HeliprSensor sensor, std::int64_t stamp_ns,
                             const std::filesystem::path& file) {
  const std::size_t points = helipr_point_count(bytes.size(), sensor, stamp_ns, file);
  const CloudHead head = head_of(sensor, stamp_ns, points);
  HeliprScan scan;
  for (const double time : numbers_of(head, head.fields[5], bytes, file)) {
    scan.times_ns.push_back(
        expect_within_second(layout_of(sensor).time_unit_s * time, file, scan.times_ns.size()));
  }
  scan.points = points_of(head, bytes, file);
  if (sensor != HeliprSensor::kAeva) return scan;
  for (const double velocity_m_s : numbers_of(head, head.fields[4], bytes, file)) {
    scan.radial_velocity_m_s.push_back(static_cast<float>(velocity_m_s));
  }
  return scan;
}

std::string format_helipr_ouster(const std::vector<Point>& points) {
  ByteSink sink;
  for (const Point& point : points) {
    sink.put(point);
    sink.put(std::uint32_t{0});
    sink.put(std::array<std::uint16_t, 3>{});
  }
  return std::move(sink).bytes();
}

std::string format_helipr_aeva(const std::vector<Point>& points,
                               const std::vector<float>& radial_velocity_m_s,
                               std::int64_t stamp_ns) {
  ByteSink sink;
  for (std::size_t i = 0; i < points.size(); ++i) {
    sink.put(points[i]);
    sink.put(radial_velocity_m_s[i]);
    sink.put(std::int32_t{0});
    sink.put(std::uint8_t{0});
    if (stamp_ns > kLastWithout_ns) sink.put(points[i].intensity);
  }
  return std::move(sink).bytes();
}

std::vector<HeliprPose> parse_helipr_poses(std::string_view text,
                                           const std::filesystem::path& file) {
  constexpr std::size_t kNumbers = 8;
  std::vector<HeliprPose> poses;
  for (const TextLine& line : split_lines(text, file)) {
    const auto parts = split_at_blanks(line.text);
    const auto stamp_ns = parts.empty() ? std::nullopt : parse_unsigned(parts.front());
    const auto refuse = [&](std::string_view) {
      throw DataError(file, line.number, quoted(line.text) + " is no pose",
                      "stamp_ns x y z qx qy qz qw with a quaternion of length 1");
    };
    if (!stamp_ns || *stamp_ns > std::uint64_t{std::numeric_limits<std::int64_t>::max()} ||
        parts.size() != kNumbers) {
      refuse("");
    }
    const auto n = parse_numbers(std::span(parts).subspan(1), refuse);
    const auto pose = pose_of({n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]});
    if (!pose) refuse("");
    poses.push_back({static_cast<std::int64_t>(*stamp_ns), *pose});
  }
  return poses;
}

std::string format_helipr_poses(const std::vector<HeliprPose>& poses) {
  std::string text;
  for (const HeliprPose& pose : poses) {
    const Eigen::Vector3d t = pose.map_from_sensor.translation();
    const Eigen::Quaterniond q(pose.map_from_sensor.linear());
    text += fmt::format("{} {} {} {} {} {} {} {}\n", pose.stamp_ns, t.x(), t.y(), t.z(), q.x(),
                        q.y(), q.z(), q.w());
  }
  return text;
}

}  // namespace mosbench
