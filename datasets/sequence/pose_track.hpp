#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <utility>
#include <vector>

namespace mosbench {

/// The pose of one frame in another as a function of time.
class PoseTrack {
 public:
  PoseTrack() = default;
  /// Poses may be in any order; of those with the same stamp the first is kept. `always` is for a
  /// transform that does not change: one pose for all times.
  explicit PoseTrack(std::vector<std::pair<std::int64_t, Pose>> poses, bool always = false);

  bool empty() const { return poses_.empty(); }
  std::int64_t first_ns() const { return poses_.front().first; }
  std::int64_t last_ns() const { return poses_.back().first; }
  bool covers(std::int64_t from_ns, std::int64_t to_ns) const;
  /// Returns the pose stored for that time, bit for bit, else one interpolated between its
  /// neighbours: positions linearly, rotations on the shortest arc. Returns nothing outside the
  /// track: no pose is extrapolated.
  std::optional<Pose> at(std::int64_t stamp_ns) const;
  /// Returns the stored pose nearest to a time, or nothing when it is farther than `most_ns`.
  std::optional<Pose> near(std::int64_t stamp_ns, std::int64_t most_ns) const;
  /// Returns the time between the two poses that `at` interpolates; 0 for a stored pose and outside
  /// the track.
  std::int64_t gap_ns(std::int64_t stamp_ns) const;
  /// Returns whether poses more than `most_ns` apart are interpolated between two times. Poses that
  /// are equal make no hole, nor do those that change little in the usual step of the track, as of
  /// a map that is corrected once a second.
  bool has_hole(std::int64_t from_ns, std::int64_t to_ns, std::int64_t most_ns) const;
  /// Returns whether any two poses differ.
  bool moves() const;

 private:
  using Stamped = std::vector<std::pair<std::int64_t, Pose>>;
  /// The first pose that is not before a time.
  Stamped::const_iterator not_before(std::int64_t stamp_ns) const;

  Stamped poses_;
  bool always_ = false;
  std::int64_t usual_step_ns_ = 0;
};

/// The ways between the poses of scans, which belong to them whatever their stamps: where stamps do
/// not increase, another way begins.
class ScanTracks {
 public:
  ScanTracks() = default;
  /// Takes the stamps and poses of scans, in their order.
  explicit ScanTracks(const std::vector<std::pair<std::int64_t, Pose>>& scans);

  const PoseTrack& around(std::size_t scan_index) const { return tracks_[track_of_[scan_index]]; }
  /// Number of scans whose stamps are not later than the one before.
  std::size_t breaks() const { return tracks_.empty() ? 0 : tracks_.size() - 1; }

 private:
  std::vector<PoseTrack> tracks_;
  std::vector<std::size_t> track_of_;
};

/// For texts.
inline double seconds_of(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

}  // namespace mosbench
