#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <optional>
#include <vector>

namespace mosbench {

/// Poses of one frame in another over time.
class PoseTrack {
 public:
  PoseTrack() = default;
  /// In any order; of poses with the same stamp the first is kept. `always` is for a transform
  /// that does not change: one pose for all times.
  explicit PoseTrack(std::vector<std::pair<std::int64_t, Pose>> poses, bool always = false);

  bool empty() const { return poses_.empty(); }
  std::int64_t first_ns() const { return poses_.front().first; }
  std::int64_t last_ns() const { return poses_.back().first; }
  bool covers(std::int64_t from_ns, std::int64_t to_ns) const;
  /// The pose stored for that time, bit for bit, else between its neighbours: positions linearly,
  /// rotations on the shortest arc. Nothing outside of the track: no pose is extrapolated.
  std::optional<Pose> at(std::int64_t stamp_ns) const;

 private:
  std::vector<std::pair<std::int64_t, Pose>> poses_;
  bool always_ = false;
};

}  // namespace mosbench
