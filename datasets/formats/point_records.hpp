#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

/// A named field of a point record.
struct CloudField {
  std::string name;
  std::uint32_t offset_bytes = 0;
  std::uint8_t datatype = 0;  ///< sensor_msgs/PointField: 1 int8 ... 6 uint32, 7 float32, 8 float64
  std::uint32_t count = 1;
};

/// Describes records of named fields: a PointCloud2 without its points, or the header of a PLY.
struct CloudHead {
  std::int64_t stamp_ns = 0;
  std::string frame;
  std::uint32_t height = 0, width = 0;
  std::vector<CloudField> fields;
  bool big_endian = false;
  std::uint32_t point_step_bytes = 0, row_step_bytes = 0;
  std::size_t records_at_bytes = 0;  ///< where in the bytes the records start
  std::uint32_t records_bytes = 0;

  std::size_t points() const { return std::size_t{height} * width; }
};

/// Returns nullptr when no field has this name.
const CloudField* find_field(const CloudHead& head, std::string_view name);

/// Returns the points that `head` describes in `bytes`, which reach at least to the end of the
/// records. Throws DataError when x, y or z is missing, or a field is no single number within the
/// record.
std::vector<Point> points_of(const CloudHead& head, std::string_view bytes,
                             const std::filesystem::path& file);

/// Return one value per record. Throw DataError when the field is no single number within it.
std::vector<double> numbers_of(const CloudHead& head, const CloudField& field,
                               std::string_view bytes, const std::filesystem::path& file);
/// Values that are no number, or beyond 10^18, become -1.
std::vector<std::int64_t> integers_of(const CloudHead& head, const CloudField& field,
                                      std::string_view bytes, const std::filesystem::path& file);

/// What an error expects where points have no times.
inline constexpr const char* kTimeFields = "a field t, time, timestamp or offset_time";

/// Whether points may say by a field of this name when they were measured: it holds "time" or
/// "stamp", or is short for such a name, in any spelling. PointClock judges what it holds.
bool is_time_field(std::string_view name);

/// Returns the first of t, time, timestamp and offset_time, else the first such field; nullptr when
/// there is none.
const CloudField* find_time_field(const CloudHead& head);

/// Returns when points were measured, as stored: by the first such field whose numbers differ; of
/// fields with seconds and nanoseconds the sum, in nanoseconds. Empty when there is none.
std::vector<double> times_of(const CloudHead& head, std::string_view bytes,
                             const std::filesystem::path& file);

/// What an error expects where points have no labels.
inline constexpr const char* kLabelFields = "a field label or scalar_label";

/// Whether points have their label id in a field of this name: label, or as CloudCompare names it,
/// scalar_label.
bool is_label_field(std::string_view name);

/// Returns the first such field; nullptr when there is none.
const CloudField* find_label_field(const CloudHead& head);

}  // namespace mosbench
