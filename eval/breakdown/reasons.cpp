#include "eval/breakdown/reasons.hpp"

#include <cmath>
#include <limits>
#include <unordered_map>
#include <vector>

#include "datasets/text/errors.hpp"
#include "eval/breakdown/object_tracks.hpp"
#include "eval/result/tell.hpp"

namespace mosbench {
namespace {

constexpr std::array<const char*, kReasonCount> kNames = {"missed", "arrived", "departed",
                                                          "grown",  "feet",    "predicted"};
constexpr double kInView_s = 1.0;
/// Places that are farther than this many cells from the map's origin share their keys with others.
constexpr std::int64_t kKeyCells = std::int64_t{1} << 20;

std::uint64_t key_of(const Eigen::Vector3d& map_m, int dx, int dy, int dz) {
  const auto part = [](double position_m, int step) {
    const auto cell = static_cast<std::int64_t>(std::floor(position_m / kPlaceCell_m)) + step;
    return static_cast<std::uint64_t>((cell + kKeyCells) & (2 * kKeyCells - 1));
  };
  return part(map_m.x(), dx) << 42 | part(map_m.y(), dy) << 21 | part(map_m.z(), dz);
}

/// Calls visit(key) for a place's cell and its 26 neighbours.
template <typename Visit>
void for_cells_of(const Eigen::Vector3d& map_m, Visit&& visit) {
  for (int i = 0; i < 27; ++i) visit(key_of(map_m, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
}

/// A false positive.
struct FalsePoint {
  Eigen::Vector3d map_m;
  double time_s;
  Reason reason;
};

/// Returns when a scan first hit each cell that lies around a false positive, in seconds.
std::unordered_map<std::uint64_t, double> first_hits(const ResultScans& scans,
                                                     const std::vector<double>& times_s,
                                                     const std::vector<FalsePoint>& points) {
  std::unordered_map<std::uint64_t, double> first;
  for (const FalsePoint& point : points) {
    for_cells_of(point.map_m, [&](std::uint64_t key) {
      first.emplace(key, std::numeric_limits<double>::infinity());
    });
  }
  if (points.empty()) return first;
  Progress progress("first hits of " + scans.sequence().name(), times_s.size());
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    const Frame frame = scans.sequence().read(k);
    for (const Point& point : frame.points) {
      const Eigen::Vector3d map_m =
          frame.map_from_sensor * Eigen::Vector3d(point.x, point.y, point.z);
      if (!map_m.allFinite()) continue;
      const auto cell = first.find(key_of(map_m, 0, 0, 0));
      if (cell != first.end()) cell->second = std::min(cell->second, times_s[k]);
    }
    progress.advance();
  }
  return first;
}

}  // namespace

ReasonTable count_reasons(const ResultScans& scans) {
  if (!scans.has_reasons()) {
    throw DataError(scans.result().folder() / "reasons", "is not there",
                    "a run of hmm-mos-plus with --write scores");
  }
  std::vector<std::size_t> all(scans.sequence().size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
  const std::vector<double> times_s = scan_times(scans.sequence(), all).times_s;
  ReasonTable table{};
  std::vector<FalsePoint> false_points;
  for (const std::size_t k : scans.scored_scans()) {
    const JudgedScan scan = scans.read(k);
    for (std::size_t i = 0; i < scan.outcomes.size(); ++i) {
      ReasonCounts& counts = table.at(static_cast<std::size_t>(scan.reasons[i]));
      const PointOutcome outcome = scan.outcomes[i];
      counts.tp += outcome == PointOutcome::kTruePositive ? 1U : 0U;
      counts.fn += outcome == PointOutcome::kFalseNegative ? 1U : 0U;
      if (outcome != PointOutcome::kFalsePositive) continue;
      ++counts.fp;
      const Point& point = scan.frame.points[i];
      false_points.push_back(
          {scan.frame.map_from_sensor * Eigen::Vector3d(point.x, point.y, point.z), times_s[k],
           scan.reasons[i]});
    }
  }
  const auto first = first_hits(scans, times_s, false_points);
  for (const FalsePoint& point : false_points) {
    double first_s = std::numeric_limits<double>::infinity();
    for_cells_of(point.map_m,
                 [&](std::uint64_t key) { first_s = std::min(first_s, first.at(key)); });
    if (first_s > point.time_s - kInView_s) {
      ++table.at(static_cast<std::size_t>(point.reason)).fp_in_view;
    }
  }
  return table;
}

nlohmann::ordered_json to_json(const ReasonTable& table) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < table.size(); ++i) {
    const ReasonCounts& counts = table[i];
    json.push_back({{"reason", kNames[i]},
                    {"tp", counts.tp},
                    {"fp", counts.fp},
                    {"fp_first_hit_within_1_s", counts.fp_in_view},
                    {"fn", counts.fn}});
  }
  return json;
}

Sheet reasons_sheet(const ReasonTable& table) {
  Sheet sheet{
      .columns = {
          {"decided by", Unit::kText}, {"TP"}, {"FP"}, {"of places first hit within 1 s"}, {"FN"}}};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const ReasonCounts& counts = table[i];
    if (counts.tp + counts.fp + counts.fn == 0) continue;
    sheet.rows.push_back({kNames[i], counts.tp, counts.fp, counts.fp_in_view, counts.fn});
  }
  return sheet;
}

}  // namespace mosbench
