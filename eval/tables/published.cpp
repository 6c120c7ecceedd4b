#include "eval/tables/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mosbench/settings.hpp>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
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

/// The text of results/published.csv, embedded by CMakeLists.txt.
std::string_view built_in_published();

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

std::span<const PaperTable> paper_tables() {
  static const std::array<PaperTable, 6> kTables = {
      PaperTable{"I",
                 "DOALS, moving IoU in % (paper, Table I)",
                 DatasetKind::kDoals,
                 "mean of the 20 labelled scans of a place's two sequences",
                 {{"ST", {"station/sequence_1", "station/sequence_2"}, 20},
                  {"SV", {"shopville/sequence_1", "shopville/sequence_2"}, 20},
                  {"HG", {"hauptgebaeude/sequence_1", "hauptgebaeude/sequence_2"}, 20},
                  {"ND", {"niederdorf/sequence_1", "niederdorf/sequence_2"}, 20}},
                 "DOALS (DOI 10.3929/ethz-c-000788171), its bags or scans exported from them"},
      PaperTable{"II",
                 "Sipailou Campus, moving IoU in % (paper, Table II)",
                 DatasetKind::kSipailou,
                 "all points of a split pooled: valid is sequence 06, test 00 and 07",
                 {{"valid", {"06"}, 3191}, {"test", {"00", "07"}, 6201}},
                 "Sipailou Campus (github.com/xieKKKi/MotionBEV)"},
      PaperTable{"III",
                 "HeLiMOS, moving IoU in % (paper, Table III)",
                 DatasetKind::kHelimos,
                 "points pooled per sensor; Avg is the plain mean of the four",
                 {{"L", {"Avia"}, std::nullopt},
                  {"A", {"Aeva"}, std::nullopt},
                  {"O", {"Ouster"}, std::nullopt},
                  {"V", {"Velodyne"}, 3164, "helimos-all"},
                  {"Avg", {"Avia", "Aeva", "Ouster", "Velodyne"}, std::nullopt}},
                 "HeLiMOS (github.com/url-kaist/HeLiMOS-PointCloud-Toolbox)"},
      PaperTable{"apollo",
                 "Apollo, moving IoU in % (HMM-MOS README)",
                 DatasetKind::kApollo,
                 "all points of both sequences pooled",
                 {{"IoU", {"00", "03"}, 2500}},
                 "Apollo LiDAR-MOS, sequences 00 and 03 (www.ipb.uni-bonn.de)"},
      PaperTable{"moe",
                 "MOE, moving IoU in % (HMM-MOS README)",
                 DatasetKind::kMoe,
                 "points pooled per sequence",
                 {{"00", {"00"}, std::nullopt},
                  {"01", {"01"}, std::nullopt},
                  {"02", {"02"}, std::nullopt}},
                 "MOE (github.com/DeepDuke/MOE-Dataset)"},
      PaperTable{"mdetector",
                 "M-detector's sets, moving IoU in % (HMM-MOS README)",
                 DatasetKind::kMdetector,
                 "points pooled per sequence, mean of sequences",
                 {{"Avia", {"Avia"}, std::nullopt},
                  {"KITTI", {"KITTI"}, std::nullopt},
                  {"nuScenes", {"nuScenes"}, std::nullopt},
                  {"Waymo", {"Waymo"}, std::nullopt}},
                 "M-detector's four sets (github.com/hku-mars/M-detector), one folder each"}};
  return kTables;
}

const PaperTable& paper_table_named(std::string_view name) {
  const auto found = std::ranges::find(
      paper_tables(), lower_case(std::string(name)),
      [](const PaperTable& table) { return lower_case(std::string(table.name)); });
  if (found != paper_tables().end()) return *found;
  throw UsageError(
      fmt::format("table: '{}' is not known, expected I, II, III, apollo, moe or mdetector", name));
}

bool contains(const TableColumn& column, const std::string& sequence) {
  return std::ranges::any_of(column.sequences, [&](std::string_view name) {
    return sequence == name || sequence.starts_with(std::string(name) + '/');
  });
}

bool contains(const PaperTable& table, const std::string& sequence) {
  return std::ranges::any_of(table.columns,
                             [&](const TableColumn& column) { return contains(column, sequence); });
}

}  // namespace mosbench
