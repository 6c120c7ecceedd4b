#pragma once

#include <cstdint>
#include <cstring>

/// Eight numbers side by side, as many as a row of a block has cells. A vector type that GCC and
/// clang cut to the registers of the machine they compile for.
namespace mosbench {

using FloatLanes = float __attribute__((vector_size(32)));
using IntLanes = std::int32_t __attribute__((vector_size(32)));
using UintLanes = std::uint32_t __attribute__((vector_size(32)));
inline constexpr std::size_t kLanes = 8;

/// Lane i is -1 where bit i is set, else 0.
inline __attribute__((always_inline)) IntLanes lanes_of(std::uint32_t bits) {
  const IntLanes all = IntLanes{} + static_cast<std::int32_t>(bits);
  return (all & IntLanes{1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}

/// Bit i is set where lane i is -1; every lane must be -1 or 0. `Lanes` has eight integers.
template <typename Lanes>
inline __attribute__((always_inline)) std::uint32_t bits_of(const Lanes& lanes) {
  Lanes bits = lanes & Lanes{1, 2, 4, 8, 16, 32, 64, 128};
  bits |= __builtin_shufflevector(bits, bits, 4, 5, 6, 7, 4, 5, 6, 7);
  bits |= __builtin_shufflevector(bits, bits, 2, 3, 2, 3, 2, 3, 2, 3);
  return static_cast<std::uint32_t>(bits[0] | bits[1]);
}

}  // namespace mosbench
