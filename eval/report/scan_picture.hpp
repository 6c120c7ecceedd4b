#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "eval/answer/picture.hpp"
#include "eval/breakdown/error_scenes.hpp"
#include "eval/breakdown/object_tracks.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

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
  ScanView(const std::optional<double>& orbit_rad, double range_m, double size_pixels);

  bool is_from_above() const { return !orbits_; }
  double pixels_per_m() const { return pixels_per_m_; }
  /// Returns nothing for what lies behind the camera or right before it.
  std::optional<ViewedPoint> seen(const Eigen::Vector3d& point_m) const;

 private:
  bool orbits_;
  double middle_, pixels_per_m_, away_m_ = 0.0;
  Eigen::Matrix3d camera_from_sensor_ = Eigen::Matrix3d::Identity();  // right, up, forward
};

/// How a scan is drawn.
struct ScanPictureOptions {
  std::size_t size_pixels = 1000;  ///< width and height
  double range_m = 0.0;  ///< from the sensor to the edge; 0: the range of 98 % of the points
  bool dark = false;
  bool by_reason = false;  ///< colours say why a point is called moving, which the scan has to know
  std::vector<ErrorScene> scenes;  ///< by point: colours say them; empty where they are not asked
  /// Where a camera looks that circles the sensor, 30 degrees above it: 0 is forward as the sensor
  /// faces, counterclockwise from above. nullopt: from straight above, the sensor in the middle and
  /// facing up.
  std::optional<double> orbit_rad;
  std::vector<std::string> title;  ///< lines in the upper left corner, as far as they have room
  std::vector<MovingBox> boxes;    ///< drawn with their speeds
};

/// Returns the range in metres that holds 98 % of the points of a scan, at least that of one ring.
double reach_m(const JudgedScan& scan);

/// Draws a scan: each point in the colour of its outcome, reason or scene, what stands out on top,
/// with counts of all points, range rings on the ground and a scale.
Picture scan_picture(const JudgedScan& scan, const ScanPictureOptions& options);

}  // namespace mosbench
