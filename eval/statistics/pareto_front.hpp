#pragma once

#include <optional>
#include <span>
#include <vector>

namespace mosbench {

/// How good a run is, and how fast.
struct IouAndTime {
  std::optional<double> iou, ms_per_scan;
};

/// Returns of each run whether it is on the front: no other is as good and as fast, and better in
/// one of both. A run that lacks a number is not, and beats none.
std::vector<bool> pareto_front(std::span<const IouAndTime> runs);

}  // namespace mosbench
