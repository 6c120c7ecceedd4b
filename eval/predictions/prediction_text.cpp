#include "eval/predictions/prediction_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestLabel = 0xFFFFFFFF;

std::uint64_t number_at(const std::vector<std::string_view>& fields, std::size_t column,
                        const TextLine& line, const fs::path& file) {
  const auto value = column < fields.size() ? parse_unsigned(fields[column]) : std::nullopt;
  if (value) return *value;
  throw DataError(
      file, line.number,
      fmt::format("column {} is {}", column + 1,
                  column < fields.size() ? mosbench::quoted(fields[column]) : "not there"),
      "a number without sign");
}

std::uint32_t moving_label(std::uint64_t flag, const TextLine& line, const fs::path& file) {
  if (flag > 1) throw DataError(file, line.number, fmt::format("says {}", flag), "0 or 1");
  return flag == 1 ? kMovingLabel : kStaticLabel;
}

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

std::vector<TextLine> lines_with_header(std::string_view text, const fs::path& file) {
  std::vector<TextLine> lines = split_lines(text, file);
  if (lines.empty()) throw DataError(file, "is empty", "a header and rows");
  return lines;
}

std::string_view cloud_column(DynabloxLevel level) {
  switch (level) {
    case DynabloxLevel::kPoint:
      return "PointDynamic";
    case DynabloxLevel::kCluster:
      return "ClusterDynamic";
    case DynabloxLevel::kObject:
      break;
  }
  return "ObjectDynamic";
}

}  // namespace

std::string_view to_string(DynabloxLevel level) {
  constexpr std::string_view kNames[] = {"point", "cluster", "object"};
  return kNames[static_cast<std::size_t>(level)];
}

DynabloxLevel dynablox_level_named(std::string_view name) {
  for (const DynabloxLevel level :
       {DynabloxLevel::kPoint, DynabloxLevel::kCluster, DynabloxLevel::kObject}) {
    if (name == to_string(level)) return level;
  }
  throw UsageError(
      fmt::format("--format dynablox: '{}' is not known, expected point, cluster or object", name));
}

std::vector<std::uint32_t> parse_point_text(std::string_view text, std::size_t point_count,
                                            const fs::path& file) {
  std::vector<std::uint32_t> labels;
  for (const TextLine& line : split_lines(text, file)) {
    const std::vector<std::string_view> fields = split_at_blanks(line.text);
    if (fields.size() != 1 && fields.size() != 3) {
      throw DataError(file, line.number, fmt::format("has {} numbers", fields.size()),
                      "0 or 1, or moveable, moving and class");
    }
    const std::size_t column = fields.size() == 1 ? 0 : 1;
    labels.push_back(moving_label(number_at(fields, column, line, file), line, file));
  }
  check_count(labels.size(), point_count, file);
  return labels;
}

std::vector<std::uint32_t> parse_point_csv(std::string_view text, std::size_t point_count,
                                           const fs::path& file) {
  const std::vector<TextLine> lines = lines_with_header(text, file);
  const std::vector<std::string_view> header = split_at_commas(lines.front().text);
  const auto label = column_named(header, "label");
  const auto moving = column_named(header, "moving");
  if (!label && !moving) throw DataError(file, 1, "names no column label or moving", "a header");
  std::vector<std::uint32_t> labels;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = split_at_commas(lines[i].text);
    const std::uint64_t value = number_at(fields, label ? *label : *moving, lines[i], file);
    if (value > kLargestLabel) {
      throw DataError(file, lines[i].number, fmt::format("says {}", value), "a label of 32 bits");
    }
    labels.push_back(label ? static_cast<std::uint32_t>(value)
                           : moving_label(value, lines[i], file));
  }
  check_count(labels.size(), point_count, file);
  return labels;
}

std::vector<std::vector<std::uint32_t>> parse_dynablox_clouds(std::string_view text,
                                                              DynabloxLevel level,
                                                              const fs::path& file) {
  const std::vector<TextLine> lines = lines_with_header(text, file);
  const std::vector<std::string_view> header = split_at_commas(lines.front().text);
  const std::size_t cloud_at = needed_column(header, "CloudNo", file);
  const std::size_t dynamic_at = needed_column(header, cloud_column(level), file);
  std::vector<std::vector<std::uint32_t>> clouds;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = split_at_commas(lines[i].text);
    const std::uint64_t cloud = number_at(fields, cloud_at, lines[i], file);
    if (cloud == clouds.size()) clouds.emplace_back();
    if (cloud + 1 != clouds.size()) {
      throw DataError(file, lines[i].number, fmt::format("is of cloud {}", cloud),
                      "clouds one after the other from 0");
    }
    clouds.back().push_back(
        moving_label(number_at(fields, dynamic_at, lines[i], file), lines[i], file));
  }
  return clouds;
}

std::vector<DynabloxCounts> parse_dynablox_counts(std::string_view text, DynabloxLevel level,
                                                  const fs::path& file) {
  // timestamp; IoU, Precision, Recall, TP, TN, FP, FN per level; EvaluatedPoints, TotalPoints.
  constexpr std::size_t kPerLevel = 7;
  constexpr std::size_t kColumns = 1 + 3 * kPerLevel + 2;
  const std::vector<TextLine> lines = lines_with_header(text, file);
  const std::size_t tp = 1 + static_cast<std::size_t>(level) * kPerLevel + 3;
  std::vector<DynabloxCounts> scores;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = split_at_commas(lines[i].text);
    if (fields.size() != kColumns) {
      throw DataError(file, lines[i].number, fmt::format("has {} columns", fields.size()),
                      fmt::format("{}", kColumns));
    }
    const auto at = [&](std::size_t column) { return number_at(fields, column, lines[i], file); };
    DynabloxCounts score{.counts = {}, .total_points = at(kColumns - 1)};
    score.counts.tp = at(tp);
    score.counts.tn = at(tp + 1);
    score.counts.fp = at(tp + 2);
    score.counts.fn = at(tp + 3);
    const std::uint64_t evaluated = at(kColumns - 2);
    // No sum can wrap to a wrong match: each count is at most what was evaluated.
    const bool fits = std::max({score.counts.tp, score.counts.tn, score.counts.fp,
                                score.counts.fn}) <= evaluated &&
                      score.counts.points() == evaluated && evaluated <= score.total_points &&
                      score.total_points <= kLargestLabel;
    if (!fits) {
      throw DataError(file, lines[i].number, "counts do not add up to the evaluated points",
                      "TP + TN + FP + FN = EvaluatedPoints <= TotalPoints");
    }
    score.counts.ignored = score.total_points - evaluated;
    scores.push_back(score);
  }
  return scores;
}

std::vector<std::uint64_t> parse_dynablox_stamps_ns(std::string_view text, const fs::path& file) {
  const std::vector<TextLine> lines = lines_with_header(text, file);
  if (split_at_commas(lines.front().text).front() != "timestamp") {
    throw DataError(file, 1, "does not begin with timestamp", "the header that Dynablox writes");
  }
  std::vector<std::uint64_t> stamps_ns;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    stamps_ns.push_back(number_at(split_at_commas(lines[i].text), 0, lines[i], file));
  }
  return stamps_ns;
}

}  // namespace mosbench
