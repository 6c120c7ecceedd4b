#pragma once

#include <cstddef>
#include <span>

namespace mosbench {

/// Returns how many consecutive scans a bootstrap has to draw together to keep their
/// autocorrelation: twice the automatic choice for the circular block bootstrap of Politis and
/// White (2004, corrected by Patton, Politis and White 2009). At least 1, at most a sixth of the
/// series.
std::size_t block_length(std::span<const double> series);

}  // namespace mosbench
