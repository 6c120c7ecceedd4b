#pragma once

#include <cstddef>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// When scans were taken.
struct ScanTimes {
  std::vector<double> times_s;  ///< one per scan, since any time that all share
  bool stamped = false;         ///< by the scans' stamps; otherwise 10 Hz is assumed
};

/// Returns the times of the scans at `scans`: their stamps where each has one and they rise, else
/// 0.1 s times their index.
ScanTimes scan_times(const Sequence& sequence, const std::vector<std::size_t>& scans);

}  // namespace mosbench
