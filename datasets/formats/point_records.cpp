#include "datasets/formats/point_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <type_traits>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Reads a value of a point and converts it from its stored type.
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

/// In the order of sensor_msgs/PointField's numbers, which start at 1.
constexpr std::array<StoredType, 8> kStoredTypes = {
    stored_type<std::int8_t>(),   stored_type<std::uint8_t>(), stored_type<std::int16_t>(),
    stored_type<std::uint16_t>(), stored_type<std::int32_t>(), stored_type<std::uint32_t>(),
    stored_type<float>(),         stored_type<double>()};

/// Where the field behind another begins: at most the end of the record.
std::uint32_t next_offset_bytes(const CloudHead& head, const CloudField& field) {
  std::uint32_t next_bytes = head.point_step_bytes;
  for (const CloudField& other : head.fields) {
    if (other.offset_bytes > field.offset_bytes)
      next_bytes = std::min(next_bytes, other.offset_bytes);
  }
  return next_bytes;
}

/// Whether a field is one number. PCL takes a count of 0 for 1. A count that does not fit before
/// the next field is that of the points, as some simulators write it.
bool is_one_number(const CloudHead& head, const CloudField& field) {
  if (field.datatype < 1 || field.datatype > kStoredTypes.size()) return false;
  const std::uint64_t all_bytes =
      std::uint64_t{field.count} * kStoredTypes[field.datatype - 1U].size_bytes;
  return field.count <= 1 || field.offset_bytes + all_bytes > next_offset_bytes(head, field);
}

const StoredType& type_of(const CloudHead& head, const CloudField& field,
                          const std::filesystem::path& file) {
  if (!is_one_number(head, field)) {
    throw DataError(file,
                    fmt::format("field {} of the points has datatype {} and count {}", field.name,
                                field.datatype, field.count),
                    "one number of datatype 1 to 8");
  }
  const StoredType& type = kStoredTypes[field.datatype - 1U];
  if (std::uint64_t{field.offset_bytes} + type.size_bytes > head.point_step_bytes) {
    throw DataError(file, "field " + field.name + " of the points lies beyond them",
                    "an offset below the point step of " + std::to_string(head.point_step_bytes));
  }
  return type;
}

/// Calls `visit(point, record)` for each point with the start of its record.
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

template <typename Wanted>
std::vector<Wanted> values_of(const CloudHead& head, const CloudField& field,
                              Load<Wanted> StoredType::*loader, std::string_view bytes,
                              const std::filesystem::path& file) {
  const Load<Wanted> load_value = type_of(head, field, file).*loader;
  std::vector<Wanted> values(head.points());
  for_each_record(head, bytes, [&](std::size_t point, const char* record) {
    values[point] = load_value(record + field.offset_bytes, head.big_endian);
  });
  return values;
}

constexpr std::array<std::string_view, 4> kUsualTimeFields = {"t", "time", "timestamp",
                                                              "offset_time"};

/// "timeStamp", "time_stamp" and "TIMESTAMP" as "timestamp".
std::string in_small_letters(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') letters += static_cast<char>(c - 'A' + 'a');
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) letters += c;
  }
  return letters;
}

/// The fields of times, those with a usual name first.
std::vector<const CloudField*> time_fields(const CloudHead& head) {
  std::vector<const CloudField*> fields;
  for (const CloudField& field : head.fields) {
    if (is_time_field(field.name)) fields.push_back(&field);
  }
  std::stable_partition(fields.begin(), fields.end(), [](const CloudField* field) {
    return std::ranges::find(kUsualTimeFields, field->name) != kUsualTimeFields.end();
  });
  return fields;
}

}  // namespace

const CloudField* find_field(const CloudHead& head, std::string_view name) {
  const auto found = std::ranges::find(head.fields, name, &CloudField::name);
  return found == head.fields.end() ? nullptr : &*found;
}

std::vector<Point> points_of(const CloudHead& head, std::string_view bytes,
                             const std::filesystem::path& file) {
  // With at least a byte per point no more memory is allocated than the file is long.
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

std::vector<double> numbers_of(const CloudHead& head, const CloudField& field,
                               std::string_view bytes, const std::filesystem::path& file) {
  return values_of(head, field, &StoredType::as_double, bytes, file);
}

std::vector<std::int64_t> integers_of(const CloudHead& head, const CloudField& field,
                                      std::string_view bytes, const std::filesystem::path& file) {
  return values_of(head, field, &StoredType::as_integer, bytes, file);
}

bool is_time_field(std::string_view name) {
  constexpr std::array<std::string_view, 8> kShort = {"t",   "ts",  "dt",      "tns",
                                                      "tus", "tms", "toffset", "deltat"};
  const std::string letters = in_small_letters(name);
  return letters.find("time") != letters.npos || letters.find("stamp") != letters.npos ||
         std::ranges::find(kShort, letters) != kShort.end();
}

const CloudField* find_time_field(const CloudHead& head) {
  const std::vector<const CloudField*> fields = time_fields(head);
  return fields.empty() ? nullptr : fields.front();
}

std::vector<double> times_of(const CloudHead& head, std::string_view bytes,
                             const std::filesystem::path& file) {
  std::vector<double> seconds, nanoseconds, first;
  for (const CloudField* field : time_fields(head)) {
    if (!first.empty() && !is_one_number(head, *field)) continue;
    std::vector<double> times = numbers_of(head, *field, bytes, file);
    if (first.empty()) first = times;
    const std::string letters = in_small_letters(field->name);
    if (letters.ends_with("nanosecond") || letters.ends_with("nsec")) {
      nanoseconds = std::move(times);
    } else if (letters.ends_with("timesecond") || letters.ends_with("psec")) {
      seconds = std::move(times);
    } else if (std::ranges::adjacent_find(times, std::not_equal_to()) != times.end()) {
      return times;
    }
  }
  if (seconds.empty() || nanoseconds.empty()) return first;
  for (std::size_t i = 0; i < seconds.size(); ++i) nanoseconds[i] += 1e9 * seconds[i];
  return nanoseconds;
}

bool is_label_field(std::string_view name) {
  const std::string lower = lower_case(std::string(name));
  return lower == "label" || lower == "scalar_label";
}

const CloudField* find_label_field(const CloudHead& head) {
  const auto field = std::ranges::find_if(head.fields, is_label_field, &CloudField::name);
  return field == head.fields.end() ? nullptr : &*field;
}

}  // namespace mosbench
