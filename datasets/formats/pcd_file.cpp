#include "datasets/formats/pcd_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// The points of a .pcd file, one after another.
struct PcdRecords {
  CloudHead head;
  std::string bytes;
};

template <typename Stored>
void store(double value, std::string_view, char* at) {
  // A cast of what does not fit is undefined.
  const auto lowest = static_cast<double>(std::numeric_limits<Stored>::lowest());
  const auto highest = static_cast<double>(std::numeric_limits<Stored>::max());
  Stored stored = 0;
  if (value >= lowest && value < highest) {
    stored = static_cast<Stored>(value);
  } else if (value >= highest) {
    stored = std::numeric_limits<Stored>::max();
  } else if (value < lowest) {
    stored = std::numeric_limits<Stored>::lowest();
  }
  std::memcpy(at, &stored, sizeof(stored));
}
/// Parsed as float32, as rounding a float64 may round twice.
template <>
void store<float>(double value, std::string_view word, char* at) {
  auto stored = static_cast<float>(value);
  float parsed = 0.0F;
  if (std::from_chars(word.data(), word.data() + word.size(), parsed).ec == std::errc{}) {
    stored = parsed;
  }
  std::memcpy(at, &stored, sizeof(stored));
}
template <>
void store<double>(double value, std::string_view, char* at) {
  std::memcpy(at, &value, sizeof(value));
}

using Store = void (*)(double value, std::string_view word, char* at);
struct StoredNumber {
  Store store;
  std::size_t size_bytes;
};
/// By the numbers of types in CloudField, which start at 1.
constexpr std::array<StoredNumber, 10> kStoredNumbers = {{{store<std::int8_t>, 1},
                                                          {store<std::uint8_t>, 1},
                                                          {store<std::int16_t>, 2},
                                                          {store<std::uint16_t>, 2},
                                                          {store<std::int32_t>, 4},
                                                          {store<std::uint32_t>, 4},
                                                          {store<float>, 4},
                                                          {store<double>, 8},
                                                          {store<std::int64_t>, 8},
                                                          {store<std::uint64_t>, 8}}};

std::optional<double> number_in(std::string_view word) {
  double number = 0.0;  // "nan" is a number here
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return number;
}

/// Stores the numbers of a row, one field after another.
void store_row(const std::vector<std::string_view>& words, const std::vector<CloudField>& fields,
               const std::string& point, const std::filesystem::path& file, char* at) {
  auto word = words.begin();
  for (const CloudField& field : fields) {
    const StoredNumber& number = kStoredNumbers[field.datatype - 1U];
    for (std::uint32_t i = 0; i < field.count; ++i, ++word, at += number.size_bytes) {
      const auto value = number_in(*word);
      if (!value) throw DataError(file, point + ": " + quoted(*word) + " is no number", "numbers");
      number.store(*value, *word, at);
    }
  }
}

std::string ascii_records(const PcdHeader& header, std::string_view body,
                          const std::filesystem::path& file) {
  std::string records;
  std::size_t rows = 0;
  for (const TextLine& line : split_lines(body, file)) {
    const auto words = split_at_blanks(line.text);
    const std::string point = "point " + std::to_string(rows++);
    if (words.size() != header.point_values) {
      throw DataError(file, point + " has " + std::to_string(words.size()) + " values",
                      std::to_string(header.point_values));
    }
    records.resize(records.size() + header.point_bytes);
    store_row(words, header.fields, point, file,
              records.data() + records.size() - header.point_bytes);
  }
  if (rows != header.points) {
    throw DataError(file, std::to_string(rows) + " rows of points", std::to_string(header.points));
  }
  return records;
}

void check_body_size(const PcdHeader& header, std::uintmax_t body_bytes,
                     std::uintmax_t wanted_bytes, const std::filesystem::path& file) {
  if (body_bytes >= wanted_bytes) return;
  throw DataError(file, fmt::format("{} bytes behind the header", body_bytes),
                  fmt::format("{} for its {} points", wanted_bytes, header.points));
}

/// Compressed bodies hold one field after another, each of all points.
std::string by_points(std::string_view by_fields, const PcdHeader& header) {
  std::string records(by_fields.size(), '\0');
  const char* from = by_fields.data();
  for (const CloudField& field : header.fields) {
    const std::size_t size_bytes = kStoredNumbers[field.datatype - 1U].size_bytes * field.count;
    char* to = records.data() + field.offset_bytes;
    for (std::size_t point = 0; point < header.points; ++point) {
      std::memcpy(to + point * header.point_bytes, from, size_bytes);
      from += size_bytes;
    }
  }
  return records;
}

std::string compressed_records(const PcdHeader& header, std::string_view body,
                               const std::filesystem::path& file) {
  std::array<std::uint32_t, 2> sizes_bytes{};  // compressed, uncompressed
  check_body_size(header, body.size(), sizeof(sizes_bytes), file);
  std::memcpy(sizes_bytes.data(), body.data(), sizeof(sizes_bytes));
  check_body_size(header, body.size(), sizeof(sizes_bytes) + sizes_bytes[0], file);
  const std::uintmax_t wanted_bytes = std::uintmax_t{header.points} * header.point_bytes;
  if (sizes_bytes[1] != wanted_bytes) {
    throw DataError(file, fmt::format("{} bytes of compressed points", sizes_bytes[1]),
                    fmt::format("{} for its {}", wanted_bytes, header.points));
  }
  const auto records = unpack_lzf(body.substr(sizeof(sizes_bytes), sizes_bytes[0]), sizes_bytes[1]);
  if (!records) {
    throw DataError(file, "its compressed points are damaged",
                    std::to_string(wanted_bytes) + " bytes packed by LZF");
  }
  return by_points(*records, header);
}

/// The records of a file without points are empty.
PcdRecords parse_records(std::string_view bytes, const std::filesystem::path& file) {
  const PcdHeader header = parse_pcd_header(bytes, file);
  const std::string_view body = bytes.substr(header.body_offset_bytes);
  PcdRecords records;
  if (header.storage == PcdStorage::kAscii) {
    records.bytes = ascii_records(header, body, file);
  } else if (header.storage == PcdStorage::kCompressed) {
    records.bytes = compressed_records(header, body, file);
  } else {
    check_body_size(header, body.size(), header.points * header.point_bytes, file);
    records.bytes = body.substr(0, header.points * header.point_bytes);
  }
  records.head.fields = header.fields;
  records.head.point_step_bytes = static_cast<std::uint32_t>(header.point_bytes);
  records.head.height = 1;
  records.head.width = static_cast<std::uint32_t>(header.points);
  return records;
}

std::vector<Point> points_in(const PcdRecords& records, const std::filesystem::path& file) {
  if (records.head.points() == 0) return {};
  return points_of(records.head, records.bytes, file);
}

std::vector<std::uint32_t> labels_in(const PcdRecords& records, const std::filesystem::path& file) {
  const CloudField* field = find_label_field(records.head);
  if (field == nullptr) throw DataError(file, "the points have no labels", kLabelFields);
  if (records.head.points() == 0) return {};
  return label_ids(numbers_of(records.head, *field, records.bytes, file), file);
}

std::vector<double> times_in(const PcdRecords& records, const std::filesystem::path& file) {
  if (records.head.points() == 0) return {};
  if (find_time_field(records.head) == nullptr) {
    throw DataError(file, "the points have no times", kTimeFields);
  }
  return times_of(records.head, records.bytes, file);
}

}  // namespace

std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size_bytes) {
  constexpr std::size_t kLiteral = 32, kLongRun = 7;
  // Three bytes stand for at most 264; a size that cannot be is no reason to allocate it.
  if (size_bytes / 88 > packed.size()) return std::nullopt;
  std::string bytes;
  bytes.reserve(size_bytes);
  std::size_t at = 0;
  const auto next = [&] { return std::size_t{static_cast<unsigned char>(packed[at++])}; };
  while (at < packed.size()) {
    const std::size_t control = next();
    if (control < kLiteral) {  // so many bytes, and one, as they are
      const std::size_t count = control + 1;
      if (count > packed.size() - at || count > size_bytes - bytes.size()) return std::nullopt;
      bytes.append(packed, at, count);
      at += count;
      continue;
    }
    // A run of bytes that are there already, three or more, so far back.
    std::size_t length = control / kLiteral;
    if (length == kLongRun) {
      if (at == packed.size()) return std::nullopt;
      length += next();
    }
    if (at == packed.size()) return std::nullopt;
    const std::size_t back = (control % kLiteral) * 256 + next() + 1;
    length += 2;
    if (back > bytes.size() || length > size_bytes - bytes.size()) return std::nullopt;
    // The run may reach into itself.
    for (std::size_t i = 0; i < length; ++i) bytes.push_back(bytes[bytes.size() - back]);
  }
  if (bytes.size() != size_bytes) return std::nullopt;
  return bytes;
}

ScanParts parse_pcd(std::string_view bytes, const std::filesystem::path& file,
                    const WantedParts& wanted) {
  const PcdRecords records = parse_records(bytes, file);
  ScanParts parts;
  parts.points = points_in(records, file);
  if (wanted.times) parts.times = times_in(records, file);
  if (wanted.labels) parts.labels = labels_in(records, file);
  return parts;
}

PcdHeader read_pcd_header(const std::filesystem::path& file) {
  const PcdHeader header = parse_pcd_header(read_head(file, "DATA"), file);
  if (header.storage != PcdStorage::kBinary) return header;  // other sizes are not known from it
  const std::uintmax_t file_bytes = size_of(file);
  check_body_size(header, file_bytes - std::min(file_bytes, header.body_offset_bytes),
                  header.points * header.point_bytes, file);
  return header;
}

std::vector<Point> read_pcd(const std::filesystem::path& file) {
  return points_in(parse_records(read_file(file), file), file);
}

std::vector<std::uint32_t> parse_pcd_labels(std::string_view bytes,
                                            const std::filesystem::path& file) {
  return labels_in(parse_records(bytes, file), file);
}

}  // namespace mosbench
