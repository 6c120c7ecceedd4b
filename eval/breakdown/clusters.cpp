#include "eval/breakdown/clusters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <unordered_map>

namespace mosbench {
namespace {

using GridCell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const GridCell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t index : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29U;
    }
    return hash;
  }
};

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

using CellMembers = std::unordered_map<GridCell, std::vector<std::uint32_t>, CellHash>;

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

}  // namespace mosbench
