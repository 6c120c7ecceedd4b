#include "eval/statistics/total_effect.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kResamples = 2000;

/// Mean of half the squared difference over the variance of all values, over some points (a point
/// may stand several times); nothing if all values are the same.
std::optional<double> index_over(std::span<const double> base, std::span<const double> varied,
                                 std::span<const std::size_t> points) {
  const double count = static_cast<double>(points.size());
  double mean = 0, squares = 0, differences = 0;
  for (const std::size_t i : points) mean += (base[i] + varied[i]) / (2 * count);
  for (const std::size_t i : points) {
    squares += (base[i] - mean) * (base[i] - mean) + (varied[i] - mean) * (varied[i] - mean);
    differences += (base[i] - varied[i]) * (base[i] - varied[i]);
  }
  if (squares <= 0) return std::nullopt;
  return differences / (2 * count) / (squares / (2 * count - 1));
}

}  // namespace

std::optional<TotalEffect> total_effect(std::span<const double> base,
                                        std::span<const double> varied) {
  if (base.size() != varied.size()) throw std::invalid_argument("values differ in number");
  if (base.size() < 3) return std::nullopt;
  std::vector<std::size_t> points(base.size());
  std::iota(points.begin(), points.end(), std::size_t{0});
  const auto index = index_over(base, varied, points);
  if (!index) return std::nullopt;
  std::vector<double> resampled;
  for (std::uint64_t i = 0; i < kResamples; ++i) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] = scatter_bits(scatter_bits(i) ^ k) % points.size();
    }
    if (const auto one = index_over(base, varied, points)) resampled.push_back(*one);
  }
  std::ranges::sort(resampled);
  const auto percentile = [&](double part) {
    return resampled[static_cast<std::size_t>(part * static_cast<double>(resampled.size() - 1))];
  };
  const double tail = (1 - kConfidence) / 2;
  return TotalEffect{*index, {percentile(tail), percentile(1 - tail)}};
}

}  // namespace mosbench
