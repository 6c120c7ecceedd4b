#include "datasets/point_cloud2.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "datasets/errors.hpp"

namespace mosbench {
namespace {

/// A value of a point by its stored type, converted.
template <typename Stored, typename Wanted>
Wanted load(const char* bytes, bool big_endian) {
  std::array<char, sizeof(Stored)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (big_endian) std::ranges::reverse(raw);
  Stored value;
  std::memcpy(&value, raw.data(), raw.size());
  if constexpr (std::is_integral_v<Wanted> && std::is_floating_point_v<Stored>) {
    return std::abs(value) < Stored{1e18F} ? static_cast<Wanted>(value) : Wanted{-1};
  } else {
    return static_cast<Wanted>(value);
  }
}

template <typename Wanted>
using Load = Wanted (*)(const char*, bool);

struct StoredType {
  std::size_t size_bytes;
  Load<float> as_float;
  Load<double> as_double;
  Load<std::int64_t> as_integer;
};

template <typename Stored>
constexpr StoredType stored_type() {
  return {sizeof(Stored), load<Stored, float>, load<Stored, double>, load<Stored, std::int64_t>};
}

/// By sensor_msgs/PointField's numbers, from 1.
constexpr std::array<StoredType, 8> kStoredTypes = {
    stored_type<std::int8_t>(),   stored_type<std::uint8_t>(), stored_type<std::int16_t>(),
    stored_type<std::uint16_t>(), stored_type<std::int32_t>(), stored_type<std::uint32_t>(),
    stored_type<float>(),         stored_type<double>()};

const CloudField* find_field(const CloudHead& head, std::string_view name) {
  const auto found = std::ranges::find(head.fields, name, &CloudField::name);
  return found == head.fields.end() ? nullptr : &*found;
}

const StoredType& type_of(const CloudHead& head, const CloudField& field,
                          const std::filesystem::path& file) {
  if (field.datatype < 1 || field.datatype > kStoredTypes.size() || field.count != 1) {
    throw DataError(file,
                    "field " + field.name + " of the points has datatype " +
                        std::to_string(field.datatype) + " and count " +
                        std::to_string(field.count),
                    "one number of datatype 1 to 8");
  }
  const StoredType& type = kStoredTypes[field.datatype - 1U];
  if (std::uint64_t{field.offset_bytes} + type.size_bytes > head.point_step_bytes) {
    throw DataError(file, "field " + field.name + " of the points lies beyond them",
                    "an offset below the point step of " + std::to_string(head.point_step_bytes));
  }
  return type;
}

/// Where each point's record starts.
template <typename Visit>
void for_each_record(const CloudHead& head, std::string_view message, Visit&& visit) {
  std::size_t point = 0;
  for (std::size_t row = 0; row < head.height; ++row) {
    const char* record = message.data() + head.records_at_bytes + row * head.row_step_bytes;
    for (std::size_t column = 0; column < head.width; ++column) {
      visit(point++, record);
      record += head.point_step_bytes;
    }
  }
}

void read_coordinate(const CloudHead& head, std::string_view message, std::string_view name,
                     float Point::*coordinate, std::vector<Point>& points,
                     const std::filesystem::path& file) {
  const CloudField* field = find_field(head, name);
  if (field == nullptr) {
    if (name == "intensity") return;
    throw DataError(file, "the points have no field " + std::string(name),
                    "fields x y z [intensity]");
  }
  const Load<float> load_value = type_of(head, *field, file).as_float;
  for_each_record(head, message, [&](std::size_t point, const char* record) {
    points[point].*coordinate = load_value(record + field->offset_bytes, head.big_endian);
  });
}

std::vector<std::int64_t> read_times(const CloudHead& head, std::string_view message,
                                     const std::filesystem::path& file) {
  std::vector<std::int64_t> times_ns;
  if (!has_times(head)) return times_ns;
  times_ns.resize(head.points());
  if (const CloudField* t = find_field(head, "t")) {
    const Load<std::int64_t> load_value = type_of(head, *t, file).as_integer;
    for_each_record(head, message, [&](std::size_t point, const char* record) {
      times_ns[point] = load_value(record + t->offset_bytes, head.big_endian);
    });
    return times_ns;
  }
  const CloudField* time = find_field(head, "time");
  const Load<double> load_value = type_of(head, *time, file).as_double;
  for_each_record(head, message, [&](std::size_t point, const char* record) {
    const double time_s = load_value(record + time->offset_bytes, head.big_endian);
    if (!(std::abs(time_s) < 1e6)) {
      throw DataError(file, "a point of a PointCloud2 has no finite time",
                      "seconds since its stamp");
    }
    times_ns[point] = std::llround(time_s * 1e9);
  });
  return times_ns;
}

}  // namespace

bool has_times(const CloudHead& head) {
  return find_field(head, "t") != nullptr || find_field(head, "time") != nullptr;
}

std::vector<Point> points_of(const CloudHead& head, std::string_view bytes,
                             const std::filesystem::path& file) {
  // A byte per point at least, so memory is taken only for what the file is long enough to hold.
  if (head.point_step_bytes == 0) {
    throw DataError(file, "has points of 0 bytes", "fields x y z [intensity]");
  }
  std::vector<Point> points(head.points());
  read_coordinate(head, bytes, "x", &Point::x, points, file);
  read_coordinate(head, bytes, "y", &Point::y, points, file);
  read_coordinate(head, bytes, "z", &Point::z, points, file);
  read_coordinate(head, bytes, "intensity", &Point::intensity, points, file);
  return points;
}

TimedCloud parse_cloud(std::string_view message, const std::filesystem::path& file) {
  const CloudHead head = parse_cloud_head(message, file);
  if (message.size() - head.records_at_bytes < head.records_bytes) {
    throw DataError(file, "a PointCloud2 ends within its points",
                    std::to_string(head.records_bytes) + " bytes of them");
  }
  TimedCloud cloud;
  cloud.stamp_ns = head.stamp_ns;
  if (head.points() == 0) return cloud;
  cloud.points = points_of(head, message, file);
  cloud.times_ns = read_times(head, message, file);
  return cloud;
}

}  // namespace mosbench
