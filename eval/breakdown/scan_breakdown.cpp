#include "eval/breakdown/scan_breakdown.hpp"

#include <algorithm>
#include <map>

#include "eval/breakdown/clusters.hpp"

namespace mosbench {
namespace {

template <std::size_t size>
std::size_t bin_of(const std::array<double, size>& edges, double value) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), value);
  return above == edges.begin() ? 0 : static_cast<std::size_t>(above - edges.begin()) - 1;
}

template <std::size_t size>
std::array<Confusion, size> to_confusions(const std::array<OutcomeCounts, size>& bins) {
  std::array<Confusion, size> confusions;
  std::ranges::transform(bins, confusions.begin(), to_confusion);
  return confusions;
}

/// Positions of points of one kind, and whether each is predicted moving.
struct Selection {
  std::vector<Eigen::Vector3d> positions_map_m;
  std::vector<bool> found;

  void add(const Eigen::Vector3d& position, bool is_found) {
    positions_map_m.push_back(position);
    found.push_back(is_found);
  }
};

ScanCluster describe(const Selection& selection, const Cluster& members, std::uint32_t instance,
                     const Eigen::Vector3d& sensor_map_m) {
  ScanCluster cluster;
  cluster.instance = instance;
  cluster.points = members.size();
  Eigen::Vector3d low = selection.positions_map_m[members.front()];
  Eigen::Vector3d high = low;
  for (const std::uint32_t member : members) {
    const Eigen::Vector3d& position = selection.positions_map_m[member];
    cluster.centre_map_m += position / static_cast<double>(members.size());
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
    cluster.found += selection.found[member] ? 1U : 0U;
  }
  cluster.range_m = (cluster.centre_map_m - sensor_map_m).norm();
  cluster.size_m = (high - low).norm();
  return cluster;
}

/// Indices of the points that have a finite position.
Cluster finite_members(const Selection& selection) {
  Cluster members;
  for (std::size_t i = 0; i < selection.positions_map_m.size(); ++i) {
    if (selection.positions_map_m[i].allFinite()) members.push_back(static_cast<std::uint32_t>(i));
  }
  return members;
}

}  // namespace

ScanBreakdown break_down_scan(const Protocol& protocol, const RangeGate& limits, const Frame& frame,
                              std::span<const std::uint32_t> prediction) {
  const std::vector<std::uint32_t>& truth = frame.truth.value();
  const std::vector<PointOutcome> outcomes =
      point_outcomes(protocol, truth, prediction, frame.points, limits);
  const Eigen::Vector3d sensor = frame.map_from_sensor.translation();
  ScanBreakdown breakdown;
  std::map<std::uint32_t, Selection> moving;  // by instance
  Selection false_positives;
  std::array<OutcomeCounts, kRangeEdges_m.size()> by_range{};
  std::array<OutcomeCounts, kHeightEdges_m.size()> by_height{};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Point& point = frame.points[i];
    const Eigen::Vector3d position =
        frame.map_from_sensor * Eigen::Vector3d(static_cast<double>(point.x),
                                                static_cast<double>(point.y),
                                                static_cast<double>(point.z));
    const auto outcome = static_cast<std::size_t>(outcomes[i]);
    ++by_range[bin_of(kRangeEdges_m, range_m(point, Arithmetic::kDouble))][outcome];
    ++by_height[bin_of(kHeightEdges_m, position.z() - sensor.z())][outcome];
    const bool found = outcomes[i] == PointOutcome::kTruePositive;
    if (found || outcomes[i] == PointOutcome::kFalseNegative) {
      moving[truth[i] >> 16U].add(position, found);
    } else if (outcomes[i] == PointOutcome::kFalsePositive) {
      false_positives.add(position, true);
    }
  }
  breakdown.by_range = to_confusions(by_range);
  breakdown.by_height = to_confusions(by_height);
  for (const auto& [instance, selection] : moving) {
    std::vector<Cluster> groups = instance == 0
                                      ? cluster_points(selection.positions_map_m, kClusterCell_m)
                                      : std::vector<Cluster>{finite_members(selection)};
    for (const Cluster& members : groups) {
      if (members.empty()) continue;
      breakdown.objects.push_back(describe(selection, members, instance, sensor));
    }
  }
  std::ranges::stable_sort(breakdown.objects, std::ranges::greater{}, &ScanCluster::points);
  for (const Cluster& members : cluster_points(false_positives.positions_map_m, kClusterCell_m)) {
    breakdown.false_positives.push_back(describe(false_positives, members, 0, sensor));
  }
  return breakdown;
}

}  // namespace mosbench
