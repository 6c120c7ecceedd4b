#include "datasets/formats/indices_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

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

}  // namespace

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

void write_indices(const std::filesystem::path& file, std::span<const IndicesRow> rows) {
  write_file_atomic(file, format_indices(rows));
}

}  // namespace mosbench
