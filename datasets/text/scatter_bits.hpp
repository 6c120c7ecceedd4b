#pragma once

#include <cstdint>

namespace mosbench {

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): a bijection that scatters every input bit.
constexpr std::uint64_t scatter_bits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

}  // namespace mosbench
