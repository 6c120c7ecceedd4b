#pragma once

#include <cstddef>
#include <span>

namespace mosbench {

/// How many neighbouring scans have to be drawn together so that a bootstrap keeps what ties scans
/// to their neighbours: the automatic choice for the circular block bootstrap from the
/// autocorrelation of `series` (Politis and White 2004, corrected by Patton, Politis and White
/// 2009). At least 1, at most a sixth of the series.
std::size_t block_length(std::span<const double> series);

}  // namespace mosbench
