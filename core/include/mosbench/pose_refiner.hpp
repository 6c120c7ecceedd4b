#pragma once

#include <cstddef>
#include <memory>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

namespace mosbench {

/// Poses that registration of the scans corrected, and how far the given ones were off.
struct RefinedPoses {
  std::vector<Pose> map_from_sensor;  ///< one per scan; the first as given
  std::vector<std::size_t> failed;    ///< scans whose registration failed: moved as given
  std::size_t corrected = 0;          ///< motions between scans that are not those given
  /// Medians over scans of the mean distance of points from the surfaces of a scan up to ten
  /// before, with the poses given and with those corrected.
  double given_fit_m = 0;
  double fit_m = 0;  ///< see given_fit_m
};

/// Corrects poses by registering every scan to the surfaces of those before, with the given motion
/// as first guess. A motion is corrected only where most pairs of scans across it fit clearly
/// better. Corrections that would last are taken back slowly, so that over long stretches the given
/// poses hold. Poses are the same bits wherever they are computed by the same program: it has one
/// thread.
class PoseRefiner {
 public:
  PoseRefiner();
  ~PoseRefiner();

  /// Takes the next scan, in the sensor's frame in metres; NaN and points out of range are left
  /// out.
  void push(std::span<const Point> points, const Pose& given);
  /// Returns the poses of all scans that were pushed.
  RefinedPoses finish() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mosbench
