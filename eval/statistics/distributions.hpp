#pragma once

#include <span>

namespace mosbench {

/// Standard normal distribution function.
double normal_probability(double z);
/// Its inverse; `probability` in (0, 1). Accurate to 1e-9.
double normal_quantile(double probability);
/// Quantile of Student's t with `freedom` >= 1 degrees of freedom, which need not be whole.
/// Accurate to 1e-6.
double student_quantile(double probability, double freedom);

/// Quantile of a sorted sample, interpolated linearly between its values (type 7 of Hyndman and
/// Fan). The sample must not be empty.
double sorted_quantile(std::span<const double> sorted, double probability);

}  // namespace mosbench
