#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/breakdown/scan_breakdown.hpp"

namespace mosbench {

/// When scans were taken.
struct ScanClock {
  std::vector<double> times_s;  ///< one per scan, since any time that all share
  bool stamped = false;         ///< by the scans' stamps; otherwise 10 Hz is assumed
};

/// Returns the times of the scans at `scans`: their stamps where each has one and they rise, else
/// 0.1 s times their index.
ScanClock scan_times(const Sequence& sequence, const std::vector<std::size_t>& scans);

/// A moving object seen in one scan.
struct Sighting {
  std::size_t scan_index;  ///< in its sequence
  double time_s;           ///< since any time that all scans share
  ScanCluster cluster;
};

/// A moving object over scans.
struct ObjectTrack {
  std::vector<Sighting> sightings;  ///< in scan order, at least one

  std::size_t points() const;
  std::size_t found() const;
  double recall() const { return static_cast<double>(found()) / static_cast<double>(points()); }
  double mean_range_m() const;
  double largest_size_m() const;
  /// Speed of the centre in the map: the median over all intervals of about a second, so that
  /// neither a change of what is seen of the object nor a turn decides; for shorter tracks over the
  /// whole track. nullopt for a single scan.
  std::optional<double> speed_m_s() const;
  /// Scans from the first sighting to the first with a tenth of its points found; nullopt if there
  /// is none.
  std::optional<std::size_t> detection_delay_scans() const;
};

/// Moving objects in the truth of one scan.
struct ScanObjects {
  std::size_t scan_index;
  double time_s;
  std::vector<ScanCluster> objects;
};

/// Links clusters over labelled scans: by instance where they have one, otherwise to the track
/// whose predicted position is nearest (nearest pairs first), at most 2 m away and unseen for at
/// most 5 scans. Deterministic; ordered by first sighting.
std::vector<ObjectTrack> link_objects(std::span<const ScanObjects> scans);

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
