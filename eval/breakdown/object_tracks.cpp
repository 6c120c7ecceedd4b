#include "eval/breakdown/object_tracks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <tuple>

#include "core/base/thread_pool.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

/// Assumed without stamps: the LiDARs of all supported data sets turn at 10 Hz.
constexpr double kScanPeriod_s = 0.1;

/// Returns seconds since the first scan; nullopt unless every scan has a stamp and the stamps
/// increase.
std::optional<std::vector<double>> stamped_times_s(const Sequence& sequence,
                                                   const std::vector<std::size_t>& scans) {
  std::vector<double> times_s;
  std::optional<std::int64_t> first_ns;
  for (const std::size_t k : scans) {
    const std::optional<std::int64_t> stamp_ns = sequence.stamp_ns(k);
    if (!stamp_ns) return std::nullopt;
    if (!first_ns) first_ns = stamp_ns;
    times_s.push_back(static_cast<double>(*stamp_ns - *first_ns) * 1e-9);
    if (times_s.size() > 1 && times_s.back() <= times_s[times_s.size() - 2]) return std::nullopt;
  }
  return times_s;
}

/// Largest distance between a cluster and the predicted position of its track, for truth without
/// instances. The prediction has constant velocity, so only acceleration and the change of what is
/// seen of an object count: 2 m is half a car, and less than the gap between two cars in traffic.
constexpr double kLinkGate_m = 2.0;
/// Longest occlusion over which a track without instance goes on: half a second at 10 Hz, after
/// which the predicted position of a turning car is wrong by about kLinkGate_m.
constexpr std::size_t kLongestGap_scans = 5;
/// Time over which a speed is measured: within a second a pedestrian walks farther than its centre
/// shifts because other parts of it are seen. Less a little, because stamps are rounded.
constexpr double kSpeedBaseline_s = 1.0 - 1e-6;
/// An object counts as detected in a scan when a tenth of its points is found.
constexpr std::size_t kPointsPerFound = 10;

/// Predicts the position of a track at constant velocity from its last two sightings.
Eigen::Vector3d expected_at(const ObjectTrack& track, std::size_t scan_index) {
  const Sighting& last = track.sightings.back();
  if (track.sightings.size() < 2) return last.cluster.centre_map_m;
  const Sighting& before = track.sightings[track.sightings.size() - 2];
  const double step = static_cast<double>(scan_index - last.scan_index) /
                      static_cast<double>(last.scan_index - before.scan_index);
  return last.cluster.centre_map_m +
         step * (last.cluster.centre_map_m - before.cluster.centre_map_m);
}

bool may_go_on(const ObjectTrack& track, std::size_t scan_index) {
  const Sighting& last = track.sightings.back();
  return last.cluster.instance != 0 || scan_index - last.scan_index <= kLongestGap_scans;
}

bool is_open(const ObjectTrack& track, const ScanCluster& cluster, std::size_t scan_index) {
  const Sighting& last = track.sightings.back();
  return last.cluster.instance == cluster.instance && last.scan_index != scan_index &&
         may_go_on(track, scan_index);
}

template <typename Value>
Value sum_of(const ObjectTrack& track, Value ScanCluster::*member) {
  Value sum{};
  for (const Sighting& sighting : track.sightings) sum += sighting.cluster.*member;
  return sum;
}

struct Pair {
  double distance_m;
  std::size_t track, cluster;
};

/// Returns the pairs that may be linked, nearest first.
std::vector<Pair> candidate_pairs(const std::vector<ObjectTrack>& tracks, const ScanObjects& scan) {
  std::vector<Pair> pairs;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    for (std::size_t c = 0; c < scan.objects.size(); ++c) {
      const ScanCluster& cluster = scan.objects[c];
      if (!is_open(tracks[t], cluster, scan.scan_index)) continue;
      const double distance_m =
          (expected_at(tracks[t], scan.scan_index) - cluster.centre_map_m).norm();
      if (cluster.instance != 0 || distance_m <= kLinkGate_m) pairs.push_back({distance_m, t, c});
    }
  }
  std::ranges::sort(pairs, {}, [](const Pair& pair) {
    return std::tuple(pair.distance_m, pair.track, pair.cluster);
  });
  return pairs;
}

void extend(std::vector<ObjectTrack>& tracks, const ScanObjects& scan) {
  const std::size_t known = tracks.size();
  std::vector<bool> track_used(known, false);
  std::vector<bool> cluster_used(scan.objects.size(), false);
  for (const Pair& pair : candidate_pairs(tracks, scan)) {
    if (track_used[pair.track] || cluster_used[pair.cluster]) continue;
    track_used[pair.track] = cluster_used[pair.cluster] = true;
    tracks[pair.track].sightings.push_back(
        {scan.scan_index, scan.time_s, scan.objects[pair.cluster]});
  }
  for (std::size_t c = 0; c < scan.objects.size(); ++c) {
    if (!cluster_used[c]) tracks.push_back({{{scan.scan_index, scan.time_s, scan.objects[c]}}});
  }
}

double speed_between(const Sighting& from, const Sighting& to) {
  return (to.cluster.centre_map_m - from.cluster.centre_map_m).norm() / (to.time_s - from.time_s);
}

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

ScanClock scan_times(const Sequence& sequence, const std::vector<std::size_t>& scans) {
  if (auto times_s = stamped_times_s(sequence, scans)) return {*std::move(times_s), true};
  ScanClock assumed;
  for (const std::size_t k : scans) {
    assumed.times_s.push_back(static_cast<double>(k) * kScanPeriod_s);
  }
  return assumed;
}

std::size_t ObjectTrack::points() const { return sum_of(*this, &ScanCluster::points); }

std::size_t ObjectTrack::found() const { return sum_of(*this, &ScanCluster::found); }

double ObjectTrack::mean_range_m() const {
  return sum_of(*this, &ScanCluster::range_m) / static_cast<double>(sightings.size());
}

double ObjectTrack::largest_size_m() const {
  double largest_m = 0.0;
  for (const Sighting& sighting : sightings) {
    largest_m = std::max(largest_m, sighting.cluster.size_m);
  }
  return largest_m;
}

std::optional<double> ObjectTrack::speed_m_s() const {
  if (sightings.size() < 2) return std::nullopt;
  std::vector<double> speeds_m_s;
  std::size_t later = 0;
  for (const Sighting& from : sightings) {
    while (later < sightings.size() && sightings[later].time_s - from.time_s < kSpeedBaseline_s)
      ++later;
    if (later == sightings.size()) break;
    speeds_m_s.push_back(speed_between(from, sightings[later]));
  }
  if (speeds_m_s.empty()) return speed_between(sightings.front(), sightings.back());
  return quantile(std::move(speeds_m_s), 0.5, QuantileRule::kInterpolated);
}

std::optional<std::size_t> ObjectTrack::detection_delay_scans() const {
  for (const Sighting& sighting : sightings) {
    const ScanCluster& cluster = sighting.cluster;
    if (cluster.found > 0 && cluster.found * kPointsPerFound >= cluster.points) {
      return sighting.scan_index - sightings.front().scan_index;
    }
  }
  return std::nullopt;
}

std::vector<ObjectTrack> link_objects(std::span<const ScanObjects> scans) {
  std::vector<ObjectTrack> finished;
  std::vector<ObjectTrack> open;
  for (const ScanObjects& scan : scans) {
    // Finished tracks are moved out, so that the cost per scan does not grow with the sequence.
    const auto closed = std::stable_partition(
        open.begin(), open.end(),
        [&](const ObjectTrack& track) { return may_go_on(track, scan.scan_index); });
    std::move(closed, open.end(), std::back_inserter(finished));
    open.erase(closed, open.end());
    extend(open, scan);
  }
  std::ranges::move(open, std::back_inserter(finished));
  std::ranges::stable_sort(
      finished, {}, [](const ObjectTrack& track) { return track.sightings.front().scan_index; });
  return finished;
}

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
