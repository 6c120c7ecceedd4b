#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace mosbench {

/// Positions of `points` (metres) that belong together.
using Cluster = std::vector<std::uint32_t>;

/// Groups points whose cells of `cell_m` touch, edges and corners included; largest first, the
/// first point deciding between equals. Points that are not finite are in no cluster.
std::vector<Cluster> cluster_points(std::span<const Eigen::Vector3d> points, double cell_m);

}  // namespace mosbench
