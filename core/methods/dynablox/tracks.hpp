#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace mosbench::dynablox {

/// Follows the centres of objects from scan to scan.
class Tracks {
 public:
  explicit Tracks(double max_distance_m) : max_distance_m_(max_distance_m) {}

  struct Track {
    std::uint32_t number = 0;  ///< from 1, never given to another object
    std::uint32_t scans = 0;   ///< in which it was seen before
  };
  /// Returns the tracks of this scan's centres, in the map frame. The nearest pair of a centre and
  /// one of the scan before is one object if at most max_distance apart, then the next nearest
  /// among the rest. The authors give a lost object's number to a new one; here it is not used
  /// again.
  std::vector<Track> follow(const std::vector<Eigen::Vector3d>& centres_m);

 private:
  double max_distance_m_;
  std::vector<Eigen::Vector3d> previous_m_;
  std::vector<Track> tracks_;  // of the previous centres
  std::uint32_t last_number_ = 0;
};

}  // namespace mosbench::dynablox
