#pragma once

namespace mosbench {

/// Standard normal distribution function.
double normal_probability(double z);
/// Quantile of the standard normal distribution; `probability` in (0, 1).
double normal_quantile(double probability);
/// Distribution function of Student's t with `freedom` >= 1 degrees of freedom.
double student_probability(double t, double freedom);
/// Quantile of Student's t with `freedom` >= 1 degrees of freedom, which need not be whole;
/// `probability` in (0, 1).
double student_quantile(double probability, double freedom);

}  // namespace mosbench
