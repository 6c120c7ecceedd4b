#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// Indices of points that form one cluster.
using Cluster = std::vector<std::uint32_t>;

/// Groups points (metres) whose cells of edge length `cell_m` are equal or touch, also at an edge
/// or a corner. Largest cluster first, equal ones by their first point. Points that are not finite
/// are in no cluster.
std::vector<Cluster> cluster_points(std::span<const Eigen::Vector3d> points, double cell_m);

/// Bins [edge, next edge), and the counts in them; the last one has no upper end.
using BinEdges = std::array<double, 9>;
using BinCounts = std::array<Confusion, 9>;

/// Of the distance from the sensor, metres.
inline constexpr BinEdges kRangeEdges_m = {0.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 75.0, 100.0};
/// Of the height above the sensor in the map's upward direction; the first has no lower end.
inline constexpr BinEdges kHeightEdges_m = {-1e30, -2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0};

/// A group of points in one scan: one object, or one cluster of false positives.
struct ScanCluster {
  std::uint32_t instance = 0;  ///< from the upper bits of the truth; 0 when there is none
  std::size_t points = 0;
  std::size_t found = 0;  ///< points of it that are predicted moving
  Eigen::Vector3d centre_map_m = Eigen::Vector3d::Zero();
  double range_m = 0.0;   ///< of the centre from the sensor
  double size_m = 0.0;    ///< diagonal of the box around the points
  std::size_t place = 0;  ///< among the clusters of its scan, for who made them
};

/// Edge of the cells of clusters, metres: larger than the gaps between returns on an object up to
/// about 50 m, smaller than the distance between two pedestrians.
inline constexpr double kClusterCell_m = 0.5;

/// Counts of one scan by range, height and object.
struct ScanBreakdown {
  BinCounts by_range, by_height;
  std::vector<ScanCluster> objects;          ///< of moving truth, largest first
  std::vector<ScanCluster> false_positives;  ///< largest first; `found` equals `points`
};

/// Breaks down a labelled scan by the protocol's rules. Moving truth is grouped by the instance in
/// the upper 16 bits of its labels or, without instances, into clusters of 0.5 m cells.
ScanBreakdown break_down_scan(const Protocol& protocol, const RangeGate& limits, const Frame& frame,
                              std::span<const std::uint32_t> prediction);

}  // namespace mosbench
