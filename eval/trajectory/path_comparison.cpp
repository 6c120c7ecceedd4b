#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/text/errors.hpp"
#include "eval/answer/answer_text.hpp"
#include "eval/statistics/statistics_report.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPercent = 100.0, kDegreesPerRad = 180.0 / std::numbers::pi;

using Scores = std::span<const TrajectoryScore>;

/// The part of a pose in two sums of errors, and how many errors begin there.
struct Start {
  double first = 0, second = 0, errors = 0;
};
/// The starts of one sequence, in order.
using Starts = std::vector<Start>;

Starts segment_starts(const std::vector<SegmentError>& first,
                      const std::vector<SegmentError>& second, double SegmentError::*error) {
  Starts starts;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (i == 0 || first[i].first != first[i - 1].first) starts.emplace_back();
    starts.back().first += first[i].*error;
    starts.back().second += second[i].*error;
    starts.back().errors += 1;
  }
  return starts;
}

Starts square_starts(const std::vector<double>& first, const std::vector<double>& second) {
  Starts starts;
  for (std::size_t i = 0; i < first.size(); ++i) {
    starts.push_back({first[i] * first[i], second[i] * second[i], 1});
  }
  return starts;
}

Start sum_of(const std::vector<Starts>& sequences) {
  Start sum;
  for (const Starts& starts : sequences) {
    for (const Start& start : starts) {
      sum.first += start.first;
      sum.second += start.second;
      sum.errors += start.errors;
    }
  }
  return sum;
}

/// The part of each start in the error of the second value minus the first. A value is a mean, or a
/// function of one with these slopes there (delta method).
std::vector<ScanErrors> start_errors(const std::vector<Starts>& sequences, const Start& sum,
                                     double first_slope, double second_slope) {
  std::vector<ScanErrors> errors;
  for (const Starts& starts : sequences) {
    if (starts.empty()) continue;
    ScanErrors& own = errors.emplace_back();
    for (const Start& start : starts) {
      const double share = start.errors / sum.errors;
      own.error.push_back(
          second_slope * (start.second / sum.errors - share * sum.second / sum.errors) -
          first_slope * (start.first / sum.errors - share * sum.first / sum.errors));
      own.weight.push_back(share);
      own.moving.push_back(0);  // nothing but the errors shows how long starts stay alike
    }
  }
  return errors;
}

/// Compares the means of errors, or the roots of their means.
PathDifference compared(PathDifference named, const std::vector<Starts>& sequences, bool of_roots) {
  const Start sum = sum_of(sequences);
  if (sum.errors == 0 || !std::isfinite(sum.first + sum.second)) return named;
  const auto value = [&](double errors) {
    return of_roots ? std::sqrt(errors / sum.errors) : errors / sum.errors;
  };
  const auto slope = [&](double at) { return !of_roots ? 1.0 : at > 0 ? 0.5 / at : 0.0; };
  named.first = value(sum.first);
  named.second = value(sum.second);
  named.difference =
      difference_of(*named.second - *named.first,
                    start_errors(sequences, sum, slope(*named.first), slope(*named.second)),
                    Spacing::kNear, {-kInfinity, kInfinity});
  return named;
}

std::vector<Starts> segments_of(Scores first, Scores second,
                                std::vector<SegmentError> TrajectoryScore::*segments,
                                double SegmentError::*error) {
  std::vector<Starts> sequences;
  for (std::size_t s = 0; s < first.size(); ++s) {
    sequences.push_back(segment_starts(first[s].*segments, second[s].*segments, error));
  }
  return sequences;
}

/// Nothing where the pairs of one estimate are not those of the other.
std::vector<Starts> squares_of(Scores first, Scores second, PoseErrors TrajectoryScore::*errors,
                               std::vector<double> PoseErrors::*error) {
  std::vector<Starts> sequences;
  for (std::size_t s = 0; s < first.size(); ++s) {
    const std::vector<double>& one = first[s].*errors.*error;
    const std::vector<double>& other = second[s].*errors.*error;
    if (one.size() != other.size()) return {};
    sequences.push_back(square_starts(one, other));
  }
  return sequences;
}

/// The number under the title of the row.
Cell shown(const PathDifference& row, const std::optional<double>& value) {
  return value ? Cell(row.shown_factor * *value) : Cell();
}

Cell shown_difference(const PathDifference& row) {
  Spread spread = spread_of(row.difference);
  if (!spread.value) return {};
  for (std::optional<double>* number : {&spread.value, &spread.low, &spread.high}) {
    if (*number) **number *= row.shown_factor;
  }
  return spread;
}

}  // namespace

void check_same_truth(std::span<const TrajectoryPair> first,
                      std::span<const TrajectoryPair> second) {
  if (first.size() != second.size()) {
    throw DataError(fmt::format("{} and {} estimates, expected two of every sequence", first.size(),
                                second.size()));
  }
  for (std::size_t s = 0; s < first.size(); ++s) {
    const auto same = [](const Pose& a, const Pose& b) { return a.matrix() == b.matrix(); };
    const bool folders = first.size() > 1;
    if ((!folders || first[s].name == second[s].name) &&
        std::ranges::equal(first[s].truth, second[s].truth, same)) {
      continue;
    }
    throw DataError(
        fmt::format("{} and {} are paired with other true poses, expected estimates of "
                    "the same scans",
                    first[s].name, second[s].name));
  }
}

std::vector<PathDifference> compare_paths(Scores first, Scores second) {
  using Score = TrajectoryScore;
  const auto segments = [&](std::string_view name, std::string_view title, double factor,
                            std::vector<SegmentError> Score::*of, double SegmentError::*error) {
    return compared({name, title, factor, {}, {}, {}}, segments_of(first, second, of, error),
                    false);
  };
  const auto roots = [&](std::string_view name, std::string_view title, double factor,
                         PoseErrors Score::*of, std::vector<double> PoseErrors::*error) {
    return compared({name, title, factor, {}, {}, {}}, squares_of(first, second, of, error), true);
  };
  constexpr double kPer100m = 100 * kDegreesPerRad;
  std::vector<PathDifference> rows = {
      segments("kitti_translation", "KITTI %", kPercent, &Score::kitti, &SegmentError::translation),
      segments("kitti_rotation_rad_per_m", "KITTI deg/100 m", kPer100m, &Score::kitti,
               &SegmentError::rotation_rad_per_m),
      segments("short_translation", "5-50 m %", kPercent, &Score::brief,
               &SegmentError::translation),
      segments("short_rotation_rad_per_m", "5-50 m deg/100 m", kPer100m, &Score::brief,
               &SegmentError::rotation_rad_per_m),
      roots("relative_translation_m", "RPE m", 1, &Score::relative, &PoseErrors::translation_m),
      roots("relative_rotation_rad", "RPE deg", kDegreesPerRad, &Score::relative,
            &PoseErrors::rotation_rad),
      roots("absolute_translation_m", "APE m", 1, &Score::absolute, &PoseErrors::translation_m),
      roots("absolute_rotation_rad", "APE deg", kDegreesPerRad, &Score::absolute,
            &PoseErrors::rotation_rad)};
  for (PathDifference& row : rows) {
    if (!row.name.starts_with("absolute") || !row.difference.value) continue;
    row.difference = {};
    row.difference.value = *row.second - *row.first;
    row.difference.no_interval = "one bad motion shifts all later positions";
  }
  return rows;
}

Sheet path_differences_sheet(std::span<const PathDifference> differences) {
  Sheet sheet{.columns = {{"error", Unit::kText},
                          {"first", Unit::kNumber, 4},
                          {"second", Unit::kNumber, 4},
                          {"difference", Unit::kChange, 4},
                          {"p", Unit::kNumber, 4},
                          {"detectable", Unit::kNumber, 4}},
              .notes = {"Difference: second - first, paired by segments and motions; below 0 the "
                        "second is better. Scans: the poses where they begin."}};
  for (const PathDifference& row : differences) {
    const Difference& found = row.difference;
    sheet.rows.push_back({std::string(row.title), shown(row, row.first), shown(row, row.second),
                          shown_difference(row), or_missing(found.p_value),
                          shown(row, found.smallest_detectable)});
    if (found.no_interval.empty()) continue;
    sheet.notes.push_back(fmt::format("no interval for {}: {}", row.title, found.no_interval));
  }
  return sheet;
}

nlohmann::ordered_json path_differences_json(std::span<const PathDifference> differences) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::object();
  for (const PathDifference& row : differences) {
    nlohmann::ordered_json& json = rows[std::string(row.name)];
    json = {{"first", json_or_null(row.first)}, {"second", json_or_null(row.second)}};
    json.update(to_json(row.difference));
  }
  return rows;
}

Sheet path_difference_records(std::span<const PathDifference> differences) {
  Sheet sheet{.columns = {{"error", Unit::kText}}};
  for (const char* name : {"first", "second", "difference", "low", "high", "p_value"}) {
    sheet.columns.push_back({name});
  }
  sheet.columns.push_back({"no_interval", Unit::kText});
  for (const PathDifference& row : differences) {
    const Spread spread = spread_of(row.difference);
    sheet.rows.push_back({std::string(row.name), or_missing(row.first), or_missing(row.second),
                          or_missing(spread.value), or_missing(spread.low), or_missing(spread.high),
                          or_missing(row.difference.p_value), spread.no_interval});
  }
  return sheet;
}

}  // namespace mosbench
