#include "eval/breakdown/scan_breakdown.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

using GridCell = std::array<std::int64_t, 3>;

using CellMembers = std::map<GridCell, std::vector<std::uint32_t>>;

/// Coordinates beyond this, far outside any map, would overflow the cell's index.
constexpr double kFarthest_m = 1e9;

bool is_usable(const Eigen::Vector3d& point) {
  return point.allFinite() && point.cwiseAbs().maxCoeff() < kFarthest_m;
}

/// Disjoint sets (union-find); the smallest member represents its set.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t member) {
    while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
    return member;
  }
  void merge(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

CellMembers sort_into_cells(std::span<const Eigen::Vector3d> points, double cell_m) {
  CellMembers cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_usable(points[i])) continue;
    GridCell cell{};
    for (std::size_t axis = 0; axis < cell.size(); ++axis) {
      cell[axis] = static_cast<std::int64_t>(
          std::floor(points[i][static_cast<Eigen::Index>(axis)] / cell_m));
    }
    cells[cell].push_back(static_cast<std::uint32_t>(i));
  }
  return cells;
}

void merge_neighbours(const CellMembers& cells, const GridCell& cell, std::uint32_t member,
                      Sets& sets) {
  for (int step = 0; step < 27; ++step) {
    const GridCell neighbour = {cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1,
                                cell[2] + step / 9 - 1};
    const auto found = cells.find(neighbour);
    if (found != cells.end()) sets.merge(member, found->second.front());
  }
}

std::size_t bin_of(const BinEdges& edges, double value) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), value);
  return above == edges.begin() ? 0 : static_cast<std::size_t>(above - edges.begin()) - 1;
}

using BinOutcomes = std::array<OutcomeCounts, BinEdges().size()>;

BinCounts to_confusions(const BinOutcomes& bins) {
  BinCounts confusions;
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

std::vector<Cluster> cluster_points(std::span<const Eigen::Vector3d> points, double cell_m) {
  const CellMembers cells = sort_into_cells(points, cell_m);
  Sets sets(points.size());
  for (const auto& [cell, members] : cells) {
    for (const std::uint32_t member : members) sets.merge(member, members.front());
    merge_neighbours(cells, cell, members.front(), sets);
  }
  std::unordered_map<std::size_t, std::size_t> cluster_of;
  std::vector<Cluster> clusters;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_usable(points[i])) continue;
    const auto [at, is_new] = cluster_of.try_emplace(sets.find(i), clusters.size());
    if (is_new) clusters.emplace_back();
    clusters[at->second].push_back(static_cast<std::uint32_t>(i));
  }
  std::ranges::stable_sort(clusters, std::ranges::greater{}, &Cluster::size);
  return clusters;
}

ScanBreakdown break_down_scan(const Protocol& protocol, const RangeGate& limits, const Frame& frame,
                              std::span<const std::uint32_t> prediction) {
  const std::vector<std::uint32_t>& truth = frame.truth.value();
  const std::vector<PointOutcome> outcomes =
      point_outcomes(protocol, truth, prediction, frame.points, limits);
  const Eigen::Vector3d sensor = frame.map_from_sensor.translation();
  ScanBreakdown breakdown;
  std::map<std::uint32_t, Selection> moving;  // by instance
  Selection false_positives;
  BinOutcomes by_range{}, by_height{};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Point& point = frame.points[i];
    const Eigen::Vector3d position = frame.map_from_sensor * position_of(point);
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
