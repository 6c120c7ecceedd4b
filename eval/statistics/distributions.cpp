#include "eval/statistics/quantiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace mosbench {
namespace {

/// Where an increasing function reaches `target`, by bisection; the ends must enclose it.
template <typename Function>
double invert(Function&& function, double target, double low, double high) {
  for (int step = 0; step < 200 && high - low > 1e-13 * (1.0 + std::abs(low)); ++step) {
    const double middle = 0.5 * (low + high);
    (function(middle) < target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Student's density at 0.
double student_peak(double freedom) {
  return std::exp(std::lgamma(0.5 * (freedom + 1.0)) - std::lgamma(0.5 * freedom)) /
         std::sqrt(freedom * std::numbers::pi);
}

/// Integral of the density from 0 to t >= 0 by Simpson's rule in u = t / (1 + t), where the long
/// tails of few degrees of freedom are smooth.
double student_half(double t, double freedom) {
  constexpr int kSteps = 256;
  const double peak = student_peak(freedom);
  const double end = t / (1.0 + t);
  const double step = end / kSteps;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = step * i;
    const double x = u / (1.0 - u);
    const double density = peak * std::pow(1.0 + x * x / freedom, -0.5 * (freedom + 1.0));
    const double value = density / ((1.0 - u) * (1.0 - u));
    const int weight = i == 0 || i == kSteps ? 1 : (i % 2 == 1 ? 4 : 2);
    sum += weight * value;
  }
  return sum * step / 3.0;
}

}  // namespace

double normal_probability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_quantile(double probability) {
  return invert(normal_probability, probability, -40.0, 40.0);
}

double student_quantile(double probability, double freedom) {
  if (probability < 0.5) return -student_quantile(1.0 - probability, freedom);
  const auto half = [freedom](double t) { return student_half(t, freedom); };
  return invert(half, probability - 0.5, 0.0, 1000.0);
}

double sorted_quantile(std::span<const double> sorted, double probability) {
  const double position =
      std::clamp(probability, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double fraction = position - static_cast<double>(below);
  return sorted[below] + fraction * (sorted[above] - sorted[below]);
}

}  // namespace mosbench
