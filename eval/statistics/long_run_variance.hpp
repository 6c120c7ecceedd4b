#pragma once

#include <span>
#include <vector>

#include "eval/statistics/neighbour_correlation.hpp"
#include "eval/statistics/uncertainty.hpp"

namespace mosbench {

/// Estimates the uncertainty of the sum of all values in `sequences`, consecutive values of
/// stationary series that are independent of each other and remember as long as `measured` says.
/// The variance is the mean square of the first cosine coefficients of each series (Mueller and
/// Watson 2008; Lazarus, Lewis, Stock and Watson 2018), corrected for what an autoregressive
/// process of first order has more power at frequency 0 than at theirs. How many coefficients are
/// taken follows from the correlation of neighbours: those whose frequencies are slower than the
/// series' memory. When even the first two are not, there is no estimate.
SumUncertainty long_run_uncertainty(std::span<const std::vector<double>> sequences,
                                    const Correlation& measured);

}  // namespace mosbench
