#include "datasets/text/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mosbench {
namespace {

/// The value of rank `rank`, from 0; those behind it are not smaller afterwards.
double select_rank(std::vector<double>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::ranges::nth_element(values, place);
  return *place;
}

double interpolated(std::vector<double>& values, double q) {
  const double position = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const double low = select_rank(values, below);
  const auto behind = values.begin() + static_cast<std::ptrdiff_t>(below) + 1;
  if (behind == values.end()) return low;
  return low +
         (position - static_cast<double>(below)) * (*std::min_element(behind, values.end()) - low);
}

}  // namespace

double quantile(std::vector<double> values, double q, QuantileRule rule) {
  q = std::clamp(q, 0.0, 1.0);
  if (rule == QuantileRule::kInterpolated) return interpolated(values, q);
  const double rank = q * static_cast<double>(values.size());
  if (rule == QuantileRule::kNearestRank) {
    return select_rank(values, static_cast<std::size_t>(std::max(1.0, std::ceil(rank))) - 1);
  }
  return select_rank(values, std::min(static_cast<std::size_t>(rank), values.size() - 1));
}

}  // namespace mosbench
