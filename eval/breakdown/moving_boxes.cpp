#include "eval/breakdown/moving_boxes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/thread_pool.hpp"
#include "eval/breakdown/object_tracks.hpp"
#include "eval/breakdown/scan_breakdown.hpp"

namespace mosbench {
namespace {

constexpr int kTurnsTried = 45;  // of a quarter turn
/// Half the time over which a velocity is measured, as a walker's centre shifts because other parts
/// are seen. More than it by a little, because stamps are rounded.
constexpr double kHalfBaseline_s = 0.5 + 1e-6;
/// Slower than this, the shift of what is seen decides where a centre seems to go.
constexpr double kFacingSpeed_m_s = 0.5;

/// What the boxes of a scan are made of.
struct ScanClusters {
  std::vector<ScanCluster> clusters;
  std::vector<MovingBox> boxes;  ///< one per cluster
};

Eigen::Matrix3d turn_about_z(double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

ScanClusters clusters_of(const std::vector<Eigen::Vector3d>& positions_map_m) {
  ScanClusters scan;
  for (const Cluster& members : cluster_points(positions_map_m, kClusterCell_m)) {
    if (members.size() < kFewestBoxPoints) break;  // the largest come first
    std::vector<Eigen::Vector3d> of_cluster;
    for (const std::uint32_t member : members) of_cluster.push_back(positions_map_m[member]);
    const MovingBox& box = scan.boxes.emplace_back(smallest_box(of_cluster));
    ScanCluster& cluster = scan.clusters.emplace_back();
    cluster.points = members.size();
    cluster.centre_map_m = box.map_from_box.translation();
    cluster.place = scan.clusters.size() - 1;
  }
  return scan;
}

/// Velocity at one sighting of a track; nullopt where no other is near enough.
std::optional<Eigen::Vector3d> velocity_at(const ObjectTrack& track, std::size_t sighting) {
  const double now_s = track.sightings[sighting].time_s;
  std::size_t first = sighting, last = sighting;
  while (first > 0 && now_s - track.sightings[first - 1].time_s <= kHalfBaseline_s) --first;
  while (last + 1 < track.sightings.size() &&
         track.sightings[last + 1].time_s - now_s <= kHalfBaseline_s) {
    ++last;
  }
  if (first == last) return std::nullopt;
  const Sighting &from = track.sightings[first], &to = track.sightings[last];
  return (to.cluster.centre_map_m - from.cluster.centre_map_m) / (to.time_s - from.time_s);
}

/// Turns a box by quarters so that its x is nearest to the way it goes.
void face_motion(MovingBox& box) {
  const Eigen::Vector3d velocity_m_s = box.velocity_m_s.value_or(Eigen::Vector3d::Zero());
  if (velocity_m_s.norm() < kFacingSpeed_m_s) return;
  const Eigen::Vector3d in_box = box.map_from_box.linear().transpose() * velocity_m_s;
  const double quarter_rad = std::numbers::pi / 2.0;
  const auto quarters = std::lround(std::atan2(in_box.y(), in_box.x()) / quarter_rad);
  box.map_from_box.linear() =
      box.map_from_box.linear() * turn_about_z(static_cast<double>(quarters) * quarter_rad);
  if (quarters % 2 != 0) std::swap(box.size_m.x(), box.size_m.y());
}

}  // namespace

MovingBox smallest_box(std::span<const Eigen::Vector3d> points_map_m) {
  MovingBox best;
  double smallest_m2 = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kTurnsTried; ++turn) {
    const Eigen::Matrix3d map_from_box = turn_about_z(std::numbers::pi / 2.0 * turn / kTurnsTried);
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;
    for (const Eigen::Vector3d& point : points_map_m) {
      const Eigen::Vector3d in_box = map_from_box.transpose() * point;
      low = low.cwiseMin(in_box);
      high = high.cwiseMax(in_box);
    }
    const Eigen::Vector3d size_m = high - low;
    if (size_m.x() * size_m.y() >= smallest_m2) continue;
    smallest_m2 = size_m.x() * size_m.y();
    best.size_m = size_m;
    best.map_from_box.linear() = map_from_box;
    best.map_from_box.translation() = map_from_box * (0.5 * (low + high));
  }
  best.points = points_map_m.size();
  return best;
}

std::vector<std::vector<MovingBox>> moving_boxes(const Sequence& sequence,
                                                 const std::vector<std::size_t>& scans,
                                                 const MovingPoints& moving_points,
                                                 unsigned threads) {
  std::vector<ScanClusters> found(scans.size());
  ThreadPool pool(threads);
  pool.for_ranges(scans.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) found[i] = clusters_of(moving_points(scans[i]));
  });
  const ScanClock times = scan_times(sequence, scans);
  std::vector<ScanObjects> objects;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    objects.push_back({scans[i], times.times_s[i], found[i].clusters});
  }
  const std::vector<ObjectTrack> tracks = link_objects(objects);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (std::size_t s = 0; s < tracks[t].sightings.size(); ++s) {
      const Sighting& sighting = tracks[t].sightings[s];
      const auto scan = std::ranges::lower_bound(scans, sighting.scan_index) - scans.begin();
      MovingBox& box = found[static_cast<std::size_t>(scan)].boxes[sighting.cluster.place];
      box.track = t + 1;
      box.velocity_m_s = velocity_at(tracks[t], s);
      face_motion(box);
    }
  }
  std::vector<std::vector<MovingBox>> boxes;
  for (ScanClusters& scan : found) boxes.push_back(std::move(scan.boxes));
  return boxes;
}

}  // namespace mosbench
