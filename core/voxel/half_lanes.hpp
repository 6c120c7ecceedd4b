#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/simd_lanes.hpp"

/// Eight numbers of 64 bits in two halves: GCC takes wider vectors of conditions apart into single
/// numbers.
namespace mosbench {

using Reals = double __attribute__((vector_size(32)));
using Longs = std::int64_t __attribute__((vector_size(32)));
using Bits = std::uint64_t __attribute__((vector_size(32)));
inline constexpr std::size_t kHalf = 4, kHalves = kLanes / kHalf;

/// Memory for the lanes of both halves.
struct alignas(32) BitArray : std::array<std::uint64_t, kLanes> {};

/// Whether all flags are set.
inline __attribute__((always_inline)) bool all(const Longs& flags) {
  return bits_of(reinterpret_cast<ByteFlags>(flags)) == 0xFFFFFFFF;
}

}  // namespace mosbench
