#include "eval/tables/published.hpp"

#include <fmt/format.h>

#include <array>
#include <mosbench/settings.hpp>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

/// The text of results/published.csv, embedded by CMakeLists.txt.
std::string_view built_in_published();

namespace {

constexpr std::string_view kHeader =
    "table,section,method,setting,variant,voxel_size_m,max_range_m,delay_scans,column,iou_percent,"
    "protocol,source,note";
constexpr std::size_t kColumns = 13;

std::vector<std::string> cells_of(const TextLine& line, const std::filesystem::path& file) {
  const std::vector<std::string_view> cells = split_at_commas(line.text);
  if (cells.size() == kColumns) return {cells.begin(), cells.end()};
  throw DataError(file, line.number, fmt::format("has {} cells", cells.size()),
                  fmt::format("{}", kColumns));
}

std::optional<double> optional_number(const std::string& cell, const TextLine& line,
                                      const std::filesystem::path& file) {
  if (cell.empty()) return std::nullopt;
  if (const auto value = parse_double(cell)) return value;
  throw DataError(file, line.number, "says " + mosbench::quoted(cell), "a number or nothing");
}

}  // namespace

double PublishedCell::iou() const { return parse_double(iou_percent).value() / 100.0; }

PublishedVariant variant_of(const PublishedCell& cell) {
  const std::size_t equals = cell.variant.find('=');
  if (equals == std::string::npos) return {std::string(common_settings::kVariant), cell.variant};
  return {cell.variant.substr(0, equals), cell.variant.substr(equals + 1)};
}

std::vector<PublishedCell> parse_published(std::string_view text,
                                           const std::filesystem::path& file) {
  const std::vector<TextLine> lines = split_lines(text, file);
  if (lines.empty() || lines.front().text != kHeader) {
    throw DataError(file, 1, "has another header", std::string(kHeader));
  }
  std::vector<PublishedCell> published;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::vector<std::string> cells = cells_of(lines[i], file);
    PublishedCell cell;
    std::size_t next = 0;
    for (std::string* field :
         {&cell.table, &cell.section, &cell.method, &cell.setting, &cell.variant}) {
      *field = std::move(cells[next++]);
    }
    cell.voxel_size_m = optional_number(cells[5], lines[i], file);
    cell.max_range_m = optional_number(cells[6], lines[i], file);
    if (const auto delay_scans = optional_number(cells[7], lines[i], file)) {
      cell.delay_scans = static_cast<int>(*delay_scans);
    }
    next = 8;
    for (std::string* field :
         {&cell.column, &cell.iou_percent, &cell.protocol, &cell.source, &cell.note}) {
      *field = std::move(cells[next++]);
    }
    if (!optional_number(cell.iou_percent, lines[i], file)) {
      throw DataError(file, lines[i].number, "has no iou_percent", "a number");
    }
    published.push_back(std::move(cell));
  }
  return published;
}

std::vector<PublishedCell> built_in_cells() {
  return parse_published(built_in_published(), "results/published.csv");
}

}  // namespace mosbench
