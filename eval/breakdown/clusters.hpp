#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace mosbench {

/// Indices of points that form one cluster.
using Cluster = std::vector<std::uint32_t>;

/// Groups points (metres) whose cells of edge length `cell_m` are equal or touch, also at an edge
/// or a corner. Largest cluster first, equal ones by their first point. Points that are not finite
/// are in no cluster.
std::vector<Cluster> cluster_points(std::span<const Eigen::Vector3d> points, double cell_m);

}  // namespace mosbench
