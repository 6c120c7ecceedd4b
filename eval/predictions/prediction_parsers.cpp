#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <string>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/npy_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"
#include "eval/predictions/prediction_files.hpp"

namespace mosbench {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kLargestLabel = 0xFFFFFFFF;
/// By DynabloxLevel.
constexpr std::array kCloudColumns = {"PointDynamic", "ClusterDynamic", "ObjectDynamic"};

/// The fields of a line.
struct Row {
  std::vector<std::string_view> fields;
  std::size_t line;
  const fs::path& file;

  [[noreturn]] void refuse(const std::string& wrong, const std::string& expected) const {
    throw DataError(file, line, wrong, expected);
  }
  std::uint64_t at(std::size_t column) const {
    const bool is_there = column < fields.size();
    const auto value = is_there ? parse_unsigned(fields[column]) : std::nullopt;
    if (value) return *value;
    refuse(fmt::format("column {} is {}", column + 1,
                       is_there ? mosbench::quoted(fields[column]) : "not there"),
           "a number without sign");
  }
  std::uint32_t label_of(std::uint64_t flag) const {
    if (flag > 1) refuse(fmt::format("says {}", flag), "0 or 1");
    return flag == 1 ? kMovingLabel : kStaticLabel;
  }
};

void check_count(std::size_t rows, std::size_t point_count, const fs::path& file) {
  if (rows == point_count) return;
  throw DataError(file, fmt::format("has {} rows of points", rows),
                  fmt::format("one per point of its scan, {}", point_count));
}

std::optional<std::size_t> column_named(const std::vector<std::string_view>& header,
                                        std::string_view name) {
  const auto found = std::ranges::find(header, name);
  if (found == header.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.begin());
}

std::size_t needed_column(const std::vector<std::string_view>& header, std::string_view name,
                          const fs::path& file) {
  if (const auto column = column_named(header, name)) return *column;
  throw DataError(file, 1, fmt::format("has no column {}", name),
                  "the header that Dynablox writes");
}

/// Returns the lines of a table; the first is its header.
std::vector<TextLine> table_of(std::string_view text, const fs::path& file) {
  std::vector<TextLine> lines = split_lines(text, file);
  if (lines.empty()) throw DataError(file, "is empty", "a header and rows");
  return lines;
}

Row row_of(const TextLine& line, const fs::path& file) {
  return {split_at_commas(line.text), line.number, file};
}

}  // namespace

std::vector<std::uint32_t> parse_point_text(std::string_view text, std::size_t point_count,
                                            const fs::path& file) {
  std::vector<std::uint32_t> labels;
  for (const TextLine& line : split_lines(text, file)) {
    const Row row{split_at_blanks(line.text), line.number, file};
    const std::size_t numbers = row.fields.size();
    if (numbers != 1 && numbers != 3) {
      row.refuse(fmt::format("has {} numbers", numbers), "0 or 1, or moveable, moving and class");
    }
    labels.push_back(row.label_of(row.at(numbers == 1 ? 0 : 1)));
  }
  check_count(labels.size(), point_count, file);
  return labels;
}

std::vector<std::vector<std::uint32_t>> parse_dynablox_clouds(std::string_view text,
                                                              DynabloxLevel level,
                                                              const fs::path& file) {
  const std::vector<TextLine> lines = table_of(text, file);
  const std::vector<std::string_view> header = split_at_commas(lines.front().text);
  const std::size_t cloud_at = needed_column(header, "CloudNo", file);
  const std::size_t dynamic_at =
      needed_column(header, kCloudColumns[static_cast<std::size_t>(level)], file);
  std::vector<std::vector<std::uint32_t>> clouds;
  for (const TextLine& line : std::span(lines).subspan<1>()) {
    const Row row = row_of(line, file);
    const std::uint64_t cloud = row.at(cloud_at);
    if (cloud == clouds.size()) clouds.emplace_back();
    if (cloud + 1 != clouds.size()) {
      row.refuse(fmt::format("is of cloud {}", cloud), "clouds one after the other from 0");
    }
    clouds.back().push_back(row.label_of(row.at(dynamic_at)));
  }
  return clouds;
}

std::vector<DynabloxCounts> parse_dynablox_counts(std::string_view text, DynabloxLevel level,
                                                  const fs::path& file) {
  // timestamp; IoU, Precision, Recall, TP, TN, FP, FN per level; EvaluatedPoints, TotalPoints.
  constexpr std::size_t kPerLevel = 7;
  constexpr std::size_t kColumns = 1 + 3 * kPerLevel + 2;
  const std::vector<TextLine> lines = table_of(text, file);
  const std::size_t tp = 1 + static_cast<std::size_t>(level) * kPerLevel + 3;
  std::vector<DynabloxCounts> scores;
  for (const TextLine& line : std::span(lines).subspan<1>()) {
    const Row row = row_of(line, file);
    if (row.fields.size() != kColumns) {
      row.refuse(fmt::format("has {} columns", row.fields.size()), fmt::format("{}", kColumns));
    }
    DynabloxCounts score{.counts = {}, .total_points = row.at(kColumns - 1)};
    score.counts.tp = row.at(tp);
    score.counts.tn = row.at(tp + 1);
    score.counts.fp = row.at(tp + 2);
    score.counts.fn = row.at(tp + 3);
    const std::uint64_t evaluated = row.at(kColumns - 2);
    // No sum can wrap to a wrong match: each count is at most what was evaluated.
    const bool fits = std::max({score.counts.tp, score.counts.tn, score.counts.fp,
                                score.counts.fn}) <= evaluated &&
                      score.counts.points() == evaluated && evaluated <= score.total_points &&
                      score.total_points <= kLargestLabel;
    if (!fits) {
      row.refuse("counts do not add up to the evaluated points",
                 "TP + TN + FP + FN = EvaluatedPoints <= TotalPoints");
    }
    score.counts.ignored = score.total_points - evaluated;
    scores.push_back(score);
  }
  return scores;
}

std::vector<std::uint64_t> parse_dynablox_stamps_ns(std::string_view text, const fs::path& file) {
  const std::vector<TextLine> lines = table_of(text, file);
  if (split_at_commas(lines.front().text).front() != "timestamp") {
    throw DataError(file, 1, "does not begin with timestamp", "the header that Dynablox writes");
  }
  std::vector<std::uint64_t> stamps_ns;
  for (const TextLine& line : std::span(lines).subspan<1>()) {
    stamps_ns.push_back(row_of(line, file).at(0));
  }
  return stamps_ns;
}

NumpyKind read_npy_kind(const fs::path& file) {
  constexpr std::size_t kLongestHeader = 65536;
  return kind_of_npy(read_start(file, kLongestHeader), file);
}

std::vector<std::uint32_t> read_npy_ids(const fs::path& file) {
  return label_ids(parse_npy(read_file(file), file).numbers, file);
}

std::vector<std::uint32_t> read_npy_labels(const fs::path& file, std::size_t point_count) {
  std::vector<std::uint32_t> labels = read_npy_ids(file);
  check_label_count(labels.size(), point_count, file);
  return labels;
}

std::vector<double> read_npy_confidences(const fs::path& file, std::size_t point_count) {
  NumpyArray array = parse_npy(read_file(file), file);
  if (array.numbers.size() != point_count) {
    throw DataError(file, fmt::format("holds {} numbers", array.numbers.size()),
                    fmt::format("one for each of the {} points of its scan", point_count));
  }
  const auto outside =
      std::ranges::find_if(array.numbers, [](double c) { return !(c >= 0.0 && c <= 1.0); });
  if (outside == array.numbers.end()) return std::move(array.numbers);
  throw DataError(file,
                  fmt::format("holds {} at point {}", *outside, outside - array.numbers.begin()),
                  "confidences from 0 to 1");
}

std::vector<std::uint32_t> labels_of_confidences(std::span<const double> confidences) {
  std::vector<std::uint32_t> labels;
  labels.reserve(confidences.size());
  for (const double confidence : confidences) {
    labels.push_back(confidence > 0.5 ? kMovingLabel : kStaticLabel);
  }
  return labels;
}

}  // namespace mosbench
