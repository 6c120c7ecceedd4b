#include "datasets/formats/bin_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

static_assert(std::endian::native == std::endian::little, "scans are copied as they are stored");

void check_bin_size(std::uintmax_t size_bytes, std::size_t columns,
                    const std::filesystem::path& file) {
  if (size_bytes % (columns * sizeof(float)) == 0) return;
  throw DataError(file,
                  std::to_string(size_bytes) + " bytes are no multiple of " +
                      std::to_string(columns * sizeof(float)) +
                      ": cut off, or raw data of another layout",
                  std::to_string(columns) + " float32 per point (x y z" +
                      (columns > 3 ? " intensity" : "") + (columns > 4 ? " ...)" : ")"));
}

std::vector<Point> parse_bin(std::string_view bytes, std::size_t columns,
                             const std::filesystem::path& file) {
  check_bin_size(bytes.size(), columns, file);
  const std::size_t record_bytes = columns * sizeof(float);
  const std::size_t taken_bytes = std::min(record_bytes, sizeof(Point));
  std::vector<Point> points(bytes.size() / record_bytes);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::memcpy(&points[i], bytes.data() + i * record_bytes, taken_bytes);
  }
  return points;
}

std::vector<std::int64_t> parse_bin_times(std::string_view bytes, std::size_t columns,
                                          const std::filesystem::path& file) {
  check_bin_size(bytes.size(), columns, file);
  const std::size_t record_bytes = columns * sizeof(float);
  std::vector<std::int64_t> times_ns(bytes.size() / record_bytes);
  for (std::size_t i = 0; i < times_ns.size(); ++i) {
    float time_s = 0;
    std::memcpy(&time_s, bytes.data() + i * record_bytes + sizeof(Point), sizeof(time_s));
    if (!(std::abs(time_s) <= 1.0F)) {
      throw DataError(file,
                      "point " + std::to_string(i) + " has the time " + std::to_string(time_s),
                      "seconds after the scan's stamp in the fifth column, within a second");
    }
    times_ns[i] = std::llround(static_cast<double>(time_s) * 1e9);
  }
  return times_ns;
}

std::vector<Point> parse_bin(std::string_view bytes, const std::filesystem::path& file) {
  return parse_bin(bytes, 4, file);
}

std::string_view format_bin(std::span<const Point> points) {
  return {reinterpret_cast<const char*>(points.data()), points.size_bytes()};
}

std::vector<Point> read_bin(const std::filesystem::path& file, std::size_t columns,
                            std::vector<Point> reused) {
  if (columns * sizeof(float) != sizeof(Point)) return parse_bin(read_file(file), columns, file);
  const std::uintmax_t size_bytes = size_of(file);
  check_bin_size(size_bytes, columns, file);
  const auto count = static_cast<std::size_t>(size_bytes) / sizeof(Point);
  if (reused.capacity() < count) reused = {};  // growing would copy old points
  reused.resize(count);
  read_file(file, std::as_writable_bytes(std::span(reused)));
  return reused;
}

void write_bin(const std::filesystem::path& file, std::span<const Point> points) {
  write_file_atomic(file, format_bin(points));
}

}  // namespace mosbench
