#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/tracks/clusters.hpp"

namespace mosbench::tracks {

/// What a track keeps of one of its clusters.
struct Sighting {
  std::uint32_t scan = 0;
  Eigen::Vector2f median_m = Eigen::Vector2f::Zero();
  Seen seen;
};

/// Says whether an object moves, by all that was seen of it. It does if it went 1.5 m along a line
/// and a fifth of its points were seen through by earlier or by later scans; or half of all looks
/// went through it, and it went 0.5 m with half of its points seen through, or was seen for less
/// than 0.5 s with three tenths. It stands if the scans on one side judged three tenths of its
/// points, and hardly any was seen through, unless it went 10 m: a car ahead hides where it will
/// be.
bool moves(std::span<const Sighting> sightings, double period_s);

/// An object over time.
class Track {
 public:
  std::uint32_t last_scan = 0;
  std::vector<Sighting> sightings;
  std::uint32_t number = 0;  ///< from 1, of those that others know of

 private:
  friend class ObjectTracks;
  std::shared_ptr<Track> merged_into_;
};

/// Links clusters of consecutive scans: a cluster goes on in the nearest one of the next scan, or
/// of the one after, as far as 10 m/s reach, at most 2 m a scan. Those that meet are one object.
class ObjectTracks {
 public:
  /// Sightings more than `window_scans` before the last scan are forgotten.
  ObjectTracks(double period_s, std::uint32_t window_scans)
      : period_s_(period_s), window_scans_(window_scans) {}

  /// Takes in the clusters of the next scan; returns the track of each.
  std::vector<std::shared_ptr<Track>> enter(std::uint32_t scan, std::span<const Cluster> clusters);
  /// Returns the track that a track is a part of by now.
  static std::shared_ptr<Track> whole(std::shared_ptr<Track> track);
  /// Says whether nothing can be added to a track any more.
  bool is_closed(const Track& track) const { return track.last_scan + kScans <= last_scan_; }

 private:
  static constexpr std::uint32_t kScans = 2;  // after which a cluster goes on at the latest
  /// A cluster that may go on.
  struct Open {
    std::uint32_t scan;
    std::vector<Cell> cells;
    Cell low, high;
    std::shared_ptr<Track> track;
    bool goes_on = false;
  };
  static Open open_of(std::uint32_t scan, const Cluster& cluster);
  std::optional<std::size_t> nearest(const Open& from, std::span<const Open> candidates) const;
  static void merge(const std::shared_ptr<Track>& track, const std::shared_ptr<Track>& into);

  double period_s_;
  std::uint32_t window_scans_;
  std::uint32_t last_scan_ = 0;
  std::deque<std::vector<Open>> recent_;  // of the last two scans
};

}  // namespace mosbench::tracks
