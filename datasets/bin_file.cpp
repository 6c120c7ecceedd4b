#include "datasets/bin_file.hpp"

#include <bit>
#include <cstring>

#include "datasets/errors.hpp"
#include "datasets/files.hpp"

namespace mosbench {

static_assert(std::endian::native == std::endian::little, "scans are copied as they are stored");

void check_bin_size(std::uintmax_t size_bytes, const std::filesystem::path& file) {
  if (size_bytes % sizeof(Point) == 0) return;
  throw DataError(file,
                  std::to_string(size_bytes) +
                      " bytes are no multiple of 16: cut off, or raw data of another layout",
                  "4 float32 per point (x y z intensity)");
}

std::vector<Point> parse_bin(std::string_view bytes, const std::filesystem::path& file) {
  check_bin_size(bytes.size(), file);
  std::vector<Point> points(bytes.size() / sizeof(Point));
  if (!points.empty()) std::memcpy(points.data(), bytes.data(), bytes.size());
  return points;
}

std::string format_bin(std::span<const Point> points) {
  std::string bytes(points.size_bytes(), '\0');
  if (!points.empty()) std::memcpy(bytes.data(), points.data(), bytes.size());
  return bytes;
}

std::vector<Point> read_bin(const std::filesystem::path& file) {
  return parse_bin(read_file(file), file);
}

void write_bin(const std::filesystem::path& file, std::span<const Point> points) {
  write_file_atomic(file, format_bin(points));
}

}  // namespace mosbench
