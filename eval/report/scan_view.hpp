#pragma once

#include <Eigen/Core>
#include <optional>

namespace mosbench {

/// From where a scan is drawn: by default from straight above, the sensor in the middle and facing
/// up.
struct ScanViewpoint {
  /// Where a camera looks that circles the sensor, 30 degrees above it: 0 is forward as the sensor
  /// faces, counterclockwise from above. nullopt: from straight above.
  std::optional<double> orbit_rad;
};

/// A place in a picture.
struct ViewedPoint {
  double x = 0.0, y = 0.0;  ///< pixels from the upper left corner
  double distance_m = 0.0;  ///< from the camera along its axis; 0 from straight above
  double scale = 1.0;       ///< of what is drawn there: 1 at the sensor, more in front of it
};

/// Projects points of the sensor frame (metres) into a square picture.
class ScanView {
 public:
  /// `range_m`: from the sensor to the picture's edge.
  ScanView(const ScanViewpoint& viewpoint, double range_m, double size_pixels);

  bool is_from_above() const { return !orbits_; }
  double pixels_per_m() const { return pixels_per_m_; }
  /// Returns nothing for what lies behind the camera or right before it.
  std::optional<ViewedPoint> seen(const Eigen::Vector3d& point_m) const;

 private:
  bool orbits_;
  double middle_, pixels_per_m_, away_m_ = 0.0;
  Eigen::Matrix3d camera_from_sensor_ = Eigen::Matrix3d::Identity();  // right, up, forward
};

}  // namespace mosbench
