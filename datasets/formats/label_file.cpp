#include "datasets/formats/label_file.hpp"

#include <bit>
#include <cstring>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

static_assert(std::endian::native == std::endian::little, "labels are copied as they are stored");

void check_label_size(std::uintmax_t size_bytes, std::size_t point_count,
                      const std::filesystem::path& file) {
  if (size_bytes == point_count * sizeof(std::uint32_t)) return;
  const std::string expected = "one uint32 for each of the " + std::to_string(point_count) +
                               " points of its scan (" +
                               std::to_string(point_count * sizeof(std::uint32_t)) + " bytes)";
  throw DataError(file, "has " + std::to_string(size_bytes) + " bytes", expected);
}

std::vector<std::uint32_t> parse_labels(std::string_view bytes, std::size_t point_count,
                                        const std::filesystem::path& file) {
  check_label_size(bytes.size(), point_count, file);
  std::vector<std::uint32_t> labels(point_count);
  if (!labels.empty()) std::memcpy(labels.data(), bytes.data(), bytes.size());
  return labels;
}

std::string_view format_labels(std::span<const std::uint32_t> labels) {
  return {reinterpret_cast<const char*>(labels.data()), labels.size_bytes()};
}

std::vector<std::uint32_t> read_labels(const std::filesystem::path& file, std::size_t point_count) {
  check_label_size(size_of(file), point_count, file);
  std::vector<std::uint32_t> labels(point_count);
  read_file(file, std::as_writable_bytes(std::span(labels)));
  return labels;
}

void write_labels(const std::filesystem::path& file, std::span<const std::uint32_t> labels) {
  write_file_atomic(file, format_labels(labels));
}

}  // namespace mosbench
