#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <mosbench/method.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/tracks/cells.hpp"
#include "core/tracks/looks.hpp"

namespace mosbench::tracks {

/// Edge of the cells of clusters.
inline constexpr float kCell_m = 0.2F;

/// A scan whose points are looked at.
struct LookedScan {
  std::span<const Eigen::Vector3f> points_m;     ///< in the sensor's frame
  std::span<const Eigen::Vector3f> positions_m;  ///< the same in the map's
  std::span<const std::uint8_t> proposed;        ///< not 0: a method calls the point moving
  double min_range_m = 0, max_range_m = 0;       ///< points outside never move
  const RayOrigins& origins;                     ///< that ranges are from
};

/// What is counted of a cluster, or of a track.
struct Seen {
  std::uint32_t points = 0;
  std::uint32_t through_before = 0, judged_before = 0;  ///< points; two earlier scans saw through
  std::uint32_t through_after = 0, judged_after = 0;    ///< the same of later scans
  std::uint32_t looks_through = 0, looks = 0;           ///< of all points

  Seen& operator+=(const Seen& other);
};

/// Points of one scan that may be one object.
struct Cluster {
  std::vector<std::uint32_t> points;  ///< those that made it first, then those that complete it
  std::vector<Reason> reasons;        ///< one per point
  std::vector<Cell> cells;            ///< of those that made it
  Eigen::Vector2f median_m = Eigen::Vector2f::Zero();
  Seen seen;
};

/// Returns the clusters of a scan. What others proposed makes them, unless three looks hit it and
/// none went through; so do points that nine of ten looks, four or more, went through, if eight of
/// them lie together. Cells at most 0.6 m apart join. Points within 0.6 m complete a cluster if
/// they were proposed, or if half of the looks went through them, or a tenth if they are no more
/// than 0.3 m above or below it.
std::vector<Cluster> find_clusters(const LookedScan& scan, std::span<const Look> looks,
                                   ThreadPool& pool);

}  // namespace mosbench::tracks
