#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
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
  /// Returns the time between the two poses that `at` interpolates; 0 for a stored pose and outside
  /// the track.
  std::int64_t gap_ns(std::int64_t stamp_ns) const;

 private:
  using Stamped = std::vector<std::pair<std::int64_t, Pose>>;
  /// The first pose that is not before a time.
  Stamped::const_iterator not_before(std::int64_t stamp_ns) const;

  Stamped poses_;
  bool always_ = false;
};

}  // namespace mosbench
