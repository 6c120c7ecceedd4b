#include "eval/predictions/npy_file.hpp"

#include <fmt/format.h>

#include <cstring>
#include <mosbench/scan.hpp>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kNpyMagic = "\x93NUMPY";

[[noreturn]] void refuse_npy(const fs::path& file, const std::string& wrong) {
  throw DataError(file, wrong, "a .npy array of float32, float64 or bool confidences");
}

/// A .npy file: its header, a Python dictionary as text, and what follows it.
struct NpyParts {
  std::string_view header, numbers;
};

NpyParts split_npy(std::string_view bytes, const fs::path& file) {
  if (!bytes.starts_with(kNpyMagic) || bytes.size() < 12) refuse_npy(file, "is no .npy file");
  const auto byte = [&](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[at]));
  };
  // The length of the header has two bytes in version 1 and four since.
  const bool short_length = byte(6) == 1;
  std::size_t length = byte(8) + (byte(9) << 8U);
  if (!short_length) length += (byte(10) << 16U) + (byte(11) << 24U);
  const std::size_t start = short_length ? 10 : 12;
  if (length > bytes.size() - start) refuse_npy(file, "ends within its header");
  return {bytes.substr(start, length), bytes.substr(start + length)};
}

/// Returns the type in the header, such as "<f4".
std::string_view type_of(std::string_view header, const fs::path& file) {
  constexpr std::string_view kKey = "'descr': '";
  const std::size_t key = header.find(kKey);
  if (key == std::string_view::npos) refuse_npy(file, "has no type in its header");
  const std::string_view rest = header.substr(key + kKey.size());
  return rest.substr(0, rest.find('\''));
}

template <typename Number>
std::vector<std::uint32_t> threshold(std::string_view numbers, std::size_t point_count,
                                     const fs::path& file) {
  if (numbers.size() != point_count * sizeof(Number)) {
    throw DataError(file, fmt::format("holds {} numbers", numbers.size() / sizeof(Number)),
                    fmt::format("one for each of the {} points of its scan", point_count));
  }
  std::vector<std::uint32_t> labels;
  labels.reserve(point_count);
  for (std::size_t i = 0; i < point_count; ++i) {
    Number number;
    std::memcpy(&number, numbers.data() + i * sizeof(Number), sizeof(Number));
    if (!(number >= Number{0} && number <= Number{1})) {
      throw DataError(file, fmt::format("holds {} at point {}", number, i),
                      "confidences from 0 to 1");
    }
    labels.push_back(static_cast<double>(number) > 0.5 ? kMovingLabel : kStaticLabel);
  }
  return labels;
}

}  // namespace

std::vector<std::uint32_t> parse_npy_labels(std::string_view bytes, std::size_t point_count,
                                            const fs::path& file) {
  const NpyParts parts = split_npy(bytes, file);
  const std::string_view type = type_of(parts.header, file);
  if (type == "<f4") return threshold<float>(parts.numbers, point_count, file);
  if (type == "<f8") return threshold<double>(parts.numbers, point_count, file);
  if (type == "|b1") return threshold<unsigned char>(parts.numbers, point_count, file);
  refuse_npy(file, fmt::format("holds numbers of type {}", type));
}

std::vector<std::uint32_t> read_npy_labels(const fs::path& file, std::size_t point_count) {
  return parse_npy_labels(read_file(file), point_count, file);
}

}  // namespace mosbench
