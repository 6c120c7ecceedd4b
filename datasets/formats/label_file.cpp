#include "datasets/formats/label_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mosbench/scan.hpp>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

std::uint64_t parse_field(std::string_view field, std::uint64_t largest, const char* what,
                          const std::filesystem::path& file, std::size_t line) {
  const auto value = parse_unsigned(field);
  if (value && *value <= largest) return *value;
  throw DataError(file, line, quoted(field) + " is no " + what,
                  "stamp_ns,index,index,... with indices from 0");
}

IndicesRow parse_row(const TextLine& line, const std::filesystem::path& file) {
  IndicesRow row;
  row.line = line.number;
  std::string_view rest = line.text;
  // The published readers accept a comma at the end of a row.
  if (rest.ends_with(',')) rest.remove_suffix(1);
  const auto next_field = [&rest] {
    const auto comma = rest.find(',');
    const std::string_view field = trim(rest.substr(0, comma));
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
    return field;
  };
  bool has_more = rest.find(',') != std::string_view::npos;
  constexpr auto kLargestStamp =
      static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  row.stamp_ns = static_cast<std::int64_t>(
      parse_field(next_field(), kLargestStamp, "time stamp in ns", file, line.number));
  while (has_more) {
    has_more = rest.find(',') != std::string_view::npos;
    row.moving.push_back(static_cast<std::uint32_t>(
        parse_field(next_field(), std::numeric_limits<std::uint32_t>::max(), "point index", file,
                    line.number)));
  }
  std::ranges::sort(row.moving);
  row.moving.erase(std::unique(row.moving.begin(), row.moving.end()), row.moving.end());
  return row;
}

constexpr const char* kLabelId = "a label id, a whole number of 32 bits";

bool is_label_id(double number) {
  return number >= 0.0 && number <= 4294967295.0 && number == std::floor(number);
}

}  // namespace

static_assert(std::endian::native == std::endian::little, "labels are copied as they are stored");

void check_label_size(std::uintmax_t size_bytes, std::size_t point_count,
                      const std::filesystem::path& file) {
  if (size_bytes == point_count * sizeof(std::uint32_t)) return;
  throw DataError(file, fmt::format("has {} bytes", size_bytes),
                  fmt::format("one uint32 for each of the {} points of its scan ({} bytes)",
                              point_count, point_count * sizeof(std::uint32_t)));
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

std::vector<std::uint32_t> label_ids(std::span<const double> numbers,
                                     const std::filesystem::path& file) {
  std::vector<std::uint32_t> labels;
  labels.reserve(numbers.size());
  for (const double number : numbers) {
    if (!is_label_id(number)) {
      throw DataError(file, fmt::format("point {} has the label {:.6g}", labels.size(), number),
                      kLabelId);
    }
    labels.push_back(static_cast<std::uint32_t>(number));
  }
  return labels;
}

void check_label_count(std::size_t labels, std::size_t point_count,
                       const std::filesystem::path& file) {
  if (labels == point_count) return;
  throw DataError(file, fmt::format("has {}", counted(labels, "label")),
                  fmt::format("one for each of the {} points of its scan", point_count));
}

std::vector<TextLine> table_lines(std::string_view text, const std::filesystem::path& file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  return split_lines(text, file);
}

std::vector<std::uint32_t> parse_point_csv(std::string_view text, std::size_t point_count,
                                           const std::filesystem::path& file) {
  const std::vector<TextLine> lines = table_lines(text, file);
  if (lines.empty()) throw DataError(file, "is empty", "a header and rows");
  const std::vector<std::string_view> header = split_at_commas(lines.front().text);
  const auto named = [&](std::string_view name) { return std::ranges::find(header, name); };
  const bool has_ids = named("label") != header.end();
  const auto column = has_ids ? named("label") : named("moving");
  if (column == header.end()) {
    throw DataError(file, 1, "names no column label or moving", "a header");
  }
  std::vector<double> ids;
  for (const TextLine& line : std::span(lines).subspan(1)) {
    const std::vector<std::string_view> fields = split_at_commas(line.text);
    const auto at = static_cast<std::size_t>(column - header.begin());
    const auto value = at < fields.size() ? parse_double(fields[at]) : std::nullopt;
    const bool fits = has_ids ? value && is_label_id(*value) : value == 0.0 || value == 1.0;
    if (!fits) {
      throw DataError(
          file, line.number,
          fmt::format("{} is {}", *column, at < fields.size() ? quoted(fields[at]) : "not there"),
          has_ids ? kLabelId : "0 or 1");
    }
    ids.push_back(has_ids ? *value : *value == 1.0 ? kMovingLabel : kStaticLabel);
  }
  check_label_count(ids.size(), point_count, file);
  return label_ids(ids, file);
}

void write_labels(const std::filesystem::path& file, std::span<const std::uint32_t> labels) {
  write_file_atomic(file, format_labels(labels));
}

std::vector<std::uint32_t> parse_moe_labels(std::string_view text, std::size_t point_count,
                                            const std::filesystem::path& file) {
  constexpr std::size_t kNumbers = 3;
  std::vector<std::uint32_t> labels;
  for (const TextLine& line : split_lines(text, file)) {
    const auto words = split_at_blanks(line.text);
    const bool numbers = words.size() == kNumbers && parse_double(words[0]) &&
                         parse_double(words[1]) && parse_double(words[2]);
    const double moving = numbers ? *parse_double(words[1]) : -1.0;
    if (moving != 0.0 && moving != 1.0) {
      throw DataError(file, line.number, quoted(line.text) + " is no label of MOE",
                      "Moveable_ID Moving_Status Class_ID, the second 0 or 1");
    }
    labels.push_back(moving == 1.0 ? kMovingLabel : kStaticLabel);
  }
  check_label_count(labels.size(), point_count, file);
  return labels;
}

std::vector<std::uint32_t> read_moe_labels(const std::filesystem::path& file,
                                           std::size_t point_count) {
  return parse_moe_labels(read_file(file), point_count, file);
}

std::vector<IndicesRow> parse_indices(std::string_view text, const std::filesystem::path& file) {
  std::vector<IndicesRow> rows;
  std::set<std::int64_t> stamps_ns;
  for (const TextLine& line : split_lines(text, file)) {
    rows.push_back(parse_row(line, file));
    if (!stamps_ns.insert(rows.back().stamp_ns).second) {
      throw DataError(file, line.number,
                      fmt::format("stamp {} for the second time", rows.back().stamp_ns),
                      "one row per scan");
    }
  }
  return rows;
}

std::string format_indices(std::span<const IndicesRow> rows) {
  std::string text;
  for (const IndicesRow& row : rows) {
    text += fmt::format("{}", row.stamp_ns);
    for (const std::uint32_t index : row.moving) text += fmt::format(",{}", index);
    text += '\n';
  }
  return text;
}

void check_indices(const IndicesRow& row, std::size_t point_count,
                   const std::filesystem::path& file) {
  if (row.moving.empty() || row.moving.back() < point_count) return;
  throw DataError(
      file, row.line, fmt::format("index {} is beyond the scan", row.moving.back()),
      fmt::format("indices below its {} points (raw order, none dropped)", point_count));
}

std::vector<IndicesRow> read_indices(const std::filesystem::path& file) {
  return parse_indices(read_file(file), file);
}

std::set<std::uint64_t> parse_split(std::string_view text, const std::filesystem::path& file) {
  std::set<std::uint64_t> numbers;
  for (const TextLine& line : split_lines(text, file)) {
    const auto number = parse_unsigned(line.text);
    if (!number) {
      throw DataError(file, line.number, quoted(line.text) + " is no frame number",
                      "one whole number per line");
    }
    numbers.insert(*number);
  }
  if (numbers.empty()) throw DataError(file, "holds no frame number", "one per line");
  return numbers;
}

std::string format_split(const std::set<std::uint64_t>& numbers) {
  std::string text;
  for (const std::uint64_t number : numbers) text += std::to_string(number) + '\n';
  return text;
}

}  // namespace mosbench
