#pragma once

#include <cstdint>
#include <vector>

namespace mosbench {

/// What a quantile is where it falls between two of the sorted values x_0 ... x_(n-1).
enum class QuantileRule {
  kInterpolated,  ///< linear between the two neighbours of (n - 1) q (type 7 of Hyndman and Fan)
  kNearestRank,   ///< the smallest value that at least q n values do not exceed (type 1)
  kUpper          ///< x_floor(q n): of an even number of values the upper middle one is the median
};

/// Quantile of a non-empty list in any order, 0 <= q <= 1.
double quantile(std::vector<double> values, double q, QuantileRule rule);

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection that scatters every input bit.
constexpr std::uint64_t scatter_bits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

}  // namespace mosbench
