#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// What the points of labelled scans do, by their labels.
struct TruthCheck {
  std::size_t scans = 0;
  std::size_t moving = 0, still = 0;  ///< labelled points
  /// Share of the points labelled moving, and of those labelled static, through whose place scans
  /// half a second and a second before or after look: what moves leaves its place.
  double moving_leaves = 0.0, still_leaves = 0.0;
  /// Mean share of moving points among the labelled points around a moving one.
  double purity = 0.0;
  std::vector<std::string> findings;
  std::vector<std::string> remarks;  ///< of what may well be right
};

/// Returns the scans with a label other than 0, which nobody gave: data sets may have labels of key
/// frames alone and files of zeros for the scans between. Reads the truth of all.
std::vector<std::size_t> scans_with_labels(const Sequence& sequence);

/// Compares labels with what other scans see, in up to a dozen labelled scans. Unless the scans
/// confirm the poses, nothing is concluded from which points leave their place. Throws DataError.
TruthCheck check_truth(const Sequence& sequence, const std::vector<Pose>& map_from_sensor,
                       bool poses_fit);

}  // namespace mosbench
