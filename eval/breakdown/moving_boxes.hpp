#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// A moving object in one scan: the box around a cluster of points that are labelled moving.
struct MovingBox {
  std::size_t track = 0;  ///< number of the object from 1, the same in all scans
  std::size_t points = 0;
  Pose map_from_box = Pose::Identity();  ///< origin in the middle, x along the motion, z up
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  ///< along x, y and z of the box
  /// In the map, from the last half second to the next one; nullopt for an object seen once.
  std::optional<Eigen::Vector3d> velocity_m_s;
};

/// Fewest points of a box: fewer are single false points, or too few to have a shape.
inline constexpr std::size_t kFewestBoxPoints = 5;

/// Returns the upright box around points (metres, map frame) whose sides have the smallest area
/// seen from above, turned about z by less than a quarter, in steps of 2 degrees. At least one
/// point, all finite.
MovingBox smallest_box(std::span<const Eigen::Vector3d> points_map_m);

/// Returns the positions (metres, map frame) of the points of a scan that are labelled moving.
/// Called by several threads.
using MovingPoints = std::function<std::vector<Eigen::Vector3d>(std::size_t scan_index)>;

/// Returns the boxes of the scans at `scans`, which rise: clusters of moving points (cells of
/// kClusterCell_m), linked as the objects of a breakdown. Boxes of what moves faster than half a
/// metre per second face the way they go. The same for any number of threads. Throws what
/// `moving_points` throws.
std::vector<std::vector<MovingBox>> moving_boxes(const Sequence& sequence,
                                                 const std::vector<std::size_t>& scans,
                                                 const MovingPoints& moving_points,
                                                 unsigned threads);

}  // namespace mosbench
