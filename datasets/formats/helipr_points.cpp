#include "datasets/formats/helipr_points.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::array<std::pair<HeliprSensor, std::string_view>, 4> kSensors = {
    {{HeliprSensor::kAeva, "Aeva"},
     {HeliprSensor::kAvia, "Avia"},
     {HeliprSensor::kOuster, "Ouster"},
     {HeliprSensor::kVelodyne, "Velodyne"}}};

/// The last scan whose points have no intensity.
constexpr std::int64_t kLastWithout_ns = 1'691'936'557'946'849'179;

std::int64_t expect_within_second(double time_s, const std::filesystem::path& file,
                                  std::size_t point) {
  if (!(std::abs(time_s) <= 1.0)) {
    throw DataError(file, point, fmt::format("is measured {} s after the stamp", time_s),
                    "a time within a second");
  }
  return std::llround(time_s * 1e9);
}

/// Reads what follows x, y and z of one point.
class PointReader {
 public:
  PointReader(HeliprSensor sensor, std::int64_t stamp_ns, HeliprScan& scan)
      : sensor_(sensor), has_intensity_(stamp_ns > kLastWithout_ns), scan_(scan) {}

  /// Returns the time after the stamp in seconds.
  double read_rest(ByteCursor& cursor, Point& point) const {
    switch (sensor_) {
      case HeliprSensor::kAeva:
        return read_aeva(cursor, point);
      case HeliprSensor::kAvia: {
        point.intensity = cursor.take<std::uint8_t>();
        cursor.take_bytes(2);  // tag, line
        return 1e-9 * cursor.take<std::uint32_t>();
      }
      case HeliprSensor::kOuster: {
        point.intensity = cursor.take<float>();
        const double time_s = 1e-9 * cursor.take<std::uint32_t>();
        cursor.take_bytes(6);  // reflectivity, ring, ambient
        return time_s;
      }
      case HeliprSensor::kVelodyne:
        point.intensity = cursor.take<float>();
        cursor.take_bytes(2);  // ring
        return double{cursor.take<float>()};
    }
    return 0.0;
  }

 private:
  double read_aeva(ByteCursor& cursor, Point& point) const {
    point.intensity = cursor.take<float>();  // reflectivity
    scan_.radial_velocity_m_s.push_back(cursor.take<float>());
    const double time_s = 1e-9 * cursor.take<std::int32_t>();
    cursor.take_bytes(1);  // line
    if (has_intensity_) point.intensity = cursor.take<float>();
    return time_s;
  }

  HeliprSensor sensor_;
  bool has_intensity_;
  HeliprScan& scan_;
};

}  // namespace

std::string_view to_string(HeliprSensor sensor) {
  return kSensors[static_cast<std::size_t>(sensor)].second;
}

std::optional<HeliprSensor> helipr_sensor_from_string(std::string_view name) {
  for (const auto& [sensor, known] : kSensors) {
    if (known == name) return sensor;
  }
  return std::nullopt;
}

std::size_t helipr_point_bytes(HeliprSensor sensor, std::int64_t stamp_ns) {
  switch (sensor) {
    case HeliprSensor::kAeva:
      return stamp_ns > kLastWithout_ns ? 29 : 25;
    case HeliprSensor::kAvia:
      return 19;
    case HeliprSensor::kOuster:
      return 26;
    case HeliprSensor::kVelodyne:
      return 22;
  }
  return 0;
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
  HeliprScan scan;
  const PointReader reader(sensor, stamp_ns, scan);
  ByteCursor cursor(bytes, file, "a point");
  for (std::size_t i = 0; i < points; ++i) {
    Point point = {};
    point.x = cursor.take<float>();
    point.y = cursor.take<float>();
    point.z = cursor.take<float>();
    const double time_s = reader.read_rest(cursor, point);
    scan.times_ns.push_back(expect_within_second(time_s, file, i));
    scan.points.push_back(point);
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
    const bool is_stamp =
        stamp_ns && *stamp_ns <= std::uint64_t{std::numeric_limits<std::int64_t>::max()};
    std::array<double, kNumbers - 1> numbers = {};
    bool is_row = is_stamp && parts.size() == kNumbers;
    for (std::size_t i = 1; is_row && i < kNumbers; ++i) {
      const auto number = parse_double(parts[i]);
      is_row = number.has_value();
      if (number) numbers[i - 1] = *number;
    }
    const auto pose = is_row ? pose_of({numbers[0], numbers[1], numbers[2]},
                                       {numbers[3], numbers[4], numbers[5], numbers[6]})
                             : std::nullopt;
    if (!pose) {
      throw DataError(file, line.number, quoted(line.text) + " is no pose",
                      "stamp_ns x y z qx qy qz qw with a quaternion of length 1");
    }
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
