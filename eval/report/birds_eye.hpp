#pragma once

#include <string>
#include <vector>

#include "eval/report/picture.hpp"
#include "eval/report/result_scans.hpp"

namespace mosbench {

/// How a scan is drawn from above.
struct BirdsEyeOptions {
  std::size_t size_pixels = 1000;  ///< width and height
  double range_m = 0.0;  ///< from the sensor to the edge; 0: the range of 98 % of the points
  bool dark = false;
  std::vector<std::string> title;  ///< lines in the upper left corner
};

/// Returns the range in metres that holds 98 % of the points of a scan, at least that of one ring.
double reach_m(const JudgedScan& scan);

/// Draws a scan from above, the sensor in the middle and facing up: each point in the colour of its
/// outcome, false ones on top, with counts of all points, range rings and a scale.
Picture birds_eye(const JudgedScan& scan, const BirdsEyeOptions& options);

}  // namespace mosbench
