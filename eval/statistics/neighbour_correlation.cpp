#include "eval/statistics/neighbour_correlation.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench {
namespace {

double mean_of_values(const std::vector<double>& series) {
  double mean = 0.0;
  for (const double value : series) mean += value / static_cast<double>(series.size());
  return mean;
}

double products_of_neighbours(const std::vector<double>& series) {
  const double mean = mean_of_values(series);
  double sum = 0.0;
  for (std::size_t k = 1; k < series.size(); ++k)
    sum += (series[k] - mean) * (series[k - 1] - mean);
  return sum;
}

}  // namespace

double squared_deviations(const std::vector<double>& series) {
  const double mean = mean_of_values(series);
  double sum = 0.0;
  for (const double value : series) sum += (value - mean) * (value - mean);
  return sum;
}

Correlation neighbour_correlation(std::span<const std::vector<double>> series) {
  // Deviations of equal values are rounding, which is alike in neighbours.
  constexpr double kRoundingOfSquares = 1e-24;
  double squares = 0.0, products = 0.0, values = 0.0, rounding = 0.0;
  for (const std::vector<double>& one : series) {
    squares += squared_deviations(one);
    products += products_of_neighbours(one);
    values += static_cast<double>(one.size());
    for (const double value : one) rounding += kRoundingOfSquares * value * value;
  }
  if (!(squares > rounding)) return {0.0, 1.0 / std::sqrt(std::max(values, 1.0))};
  const auto count = static_cast<double>(series.size());
  const double length = values / count;
  const double measured = products / squares * values / (values - count);
  const double value = std::min(1.0, (length * measured + 1.0) / (length - 3.0));
  return {value, std::sqrt(std::max(0.0, 1.0 - value * value) / values)};
}

}  // namespace mosbench
