#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "eval/answer/picture.hpp"
#include "eval/breakdown/moving_boxes.hpp"
#include "eval/report/scan_view.hpp"
#include "eval/result/result_scans.hpp"

namespace mosbench {

/// How a scan is drawn.
struct ScanPictureOptions {
  std::size_t size_pixels = 1000;  ///< width and height
  double range_m = 0.0;  ///< from the sensor to the edge; 0: the range of 98 % of the points
  bool dark = false;
  bool by_reason = false;  ///< colours say why a point is called moving, which the scan has to know
  ScanViewpoint viewpoint;
  std::vector<std::string> title;  ///< lines in the upper left corner
  std::vector<MovingBox> boxes;    ///< drawn with their speeds
};

/// Returns the range in metres that holds 98 % of the points of a scan, at least that of one ring.
double reach_m(const JudgedScan& scan);

/// Returns the corners of a box in the map: the four of its bottom in a circle, then those above.
std::array<Eigen::Vector3d, 8> corners_of(const MovingBox& box);

/// Draws a scan: each point in the colour of its outcome or reason, what stands out on top, with
/// counts of all points, range rings on the ground and a scale.
Picture scan_picture(const JudgedScan& scan, const ScanPictureOptions& options);

}  // namespace mosbench
