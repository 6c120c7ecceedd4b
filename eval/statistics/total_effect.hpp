#pragma once

#include <optional>
#include <span>

#include "eval/statistics/intervals.hpp"

namespace mosbench {

/// How much of the variance of a value is left when all inputs but one are known.
struct TotalEffect {
  double index;       ///< 0: the input decides nothing, 1: all; an estimate may lie above
  Interval interval;  ///< 95 %
};

/// Estimates the total-effect index of an input (Jansen 1999; Saltelli et al. 2010, table 2 f).
/// `base` holds the value at points drawn independently of each other, `varied` at the same points
/// with this input drawn anew. The interval is that of a bootstrap over points, by percentiles.
/// Returns nothing below three points, and where no value differs. Throws std::invalid_argument
/// for lengths that differ.
std::optional<TotalEffect> total_effect(std::span<const double> base,
                                        std::span<const double> varied);

}  // namespace mosbench
