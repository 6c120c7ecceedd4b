#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

/// Vectors of mostly eight numbers, as many as a row of a block has cells. GCC and clang split
/// these types into registers of the target machine.
namespace mosbench {

using FloatLanes = float __attribute__((vector_size(32)));
using IntLanes = std::int32_t __attribute__((vector_size(32)));
using UintLanes = std::uint32_t __attribute__((vector_size(32)));
using ByteLanes = std::uint8_t __attribute__((vector_size(8)));
/// Results of comparing 32 bytes or 16 numbers.
using ByteFlags = std::int8_t __attribute__((vector_size(32)));
using ShortFlags = std::int16_t __attribute__((vector_size(32)));
using ShortLanes = std::int16_t __attribute__((vector_size(16)));
inline constexpr std::size_t kLanes = 8;

/// Memory into which lanes are stored to be loaded one at a time. Not by memcpy, which GCC 12
/// splits into halves through general registers, at several times the cost.
struct alignas(32) LaneArray : std::array<std::uint32_t, kLanes> {};

template <typename Lanes>
inline __attribute__((always_inline)) void store(const Lanes& lanes, LaneArray& array) {
  static_assert(sizeof(Lanes) == sizeof(array));
  typedef Lanes Aliasing __attribute__((may_alias));
  *reinterpret_cast<Aliasing*>(array.data()) = lanes;
  // A lane extracted from a register costs two operations, a loaded one: force loads.
  __asm__("" : "+m"(array));
}

/// Loads lanes from any address.
template <typename Lanes>
inline __attribute__((always_inline)) Lanes load(const void* from) {
  typedef Lanes Unaligned __attribute__((may_alias, aligned(1)));
  return *static_cast<const Unaligned*>(from);
}
template <typename Lanes>
inline __attribute__((always_inline)) void store(const Lanes& lanes, void* to) {
  typedef Lanes Unaligned __attribute__((may_alias, aligned(1)));
  *static_cast<Unaligned*>(to) = lanes;
}

/// Returns |x| of each lane.
template <typename Lanes>
inline __attribute__((always_inline)) Lanes magnitude(const Lanes& lanes) {
  return lanes < 0 ? -lanes : lanes;
}

/// Lane i is -1 where bit i is set, else 0.
inline __attribute__((always_inline)) IntLanes lanes_of(std::uint32_t bits) {
  const IntLanes all = IntLanes{} + static_cast<std::int32_t>(bits);
  return (all & IntLanes{1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}

/// Bit i is set where lane i is -1; every lane must be -1 or 0.
inline __attribute__((always_inline)) std::uint32_t bits_of(const ByteFlags& lanes) {
#if defined(__SSE2__)
  const auto low =
      __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const auto high = __builtin_shufflevector(lanes, lanes, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25,
                                            26, 27, 28, 29, 30, 31);
  return static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(low))) |
         static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(high))) << 16;
#else
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < sizeof(lanes); ++i) bits |= std::uint32_t{lanes[i] != 0} << i;
  return bits;
#endif
}
/// The same for two vectors, `low` first.
inline __attribute__((always_inline)) std::uint32_t bits_of(const ShortLanes& low,
                                                            const ShortLanes& high) {
#if defined(__SSE2__)
  const __m128i bytes =
      _mm_packs_epi16(reinterpret_cast<__m128i>(low), reinterpret_cast<__m128i>(high));
  return static_cast<std::uint32_t>(_mm_movemask_epi8(bytes));
#else
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    bits |= static_cast<std::uint32_t>(low[i] & 1) << i | static_cast<std::uint32_t>(high[i] & 1)
                                                              << (kLanes + i);
  }
  return bits;
#endif
}
inline __attribute__((always_inline)) std::uint32_t bits_of(const ShortFlags& lanes) {
  return bits_of(__builtin_shufflevector(lanes, lanes, 0, 1, 2, 3, 4, 5, 6, 7),
                 __builtin_shufflevector(lanes, lanes, 8, 9, 10, 11, 12, 13, 14, 15));
}
inline __attribute__((always_inline)) std::uint32_t bits_of(const IntLanes& lanes) {
#if defined(__SSE2__)
  const auto low = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3);
  const auto high = __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  const __m128i words =
      _mm_packs_epi32(reinterpret_cast<__m128i>(low), reinterpret_cast<__m128i>(high));
  return bits_of(reinterpret_cast<ShortLanes>(words), ShortLanes{});
#else
  return bits_of(__builtin_convertvector(lanes, ShortLanes), ShortLanes{});
#endif
}

/// Returns a plane of eight rows of bits, with row y replaced by `bits`.
inline __attribute__((always_inline)) std::uint64_t with_row(std::uint64_t word, std::size_t y,
                                                             std::uint32_t bits) {
  return (word & ~(std::uint64_t{0xFF} << (8 * y))) | std::uint64_t{bits} << (8 * y);
}

}  // namespace mosbench
