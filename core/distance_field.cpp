#include "core/distance_field.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/lanes.hpp"
#include "core/multiarch.hpp"

namespace mosbench {
namespace {

constexpr int kPlane = kBlockSide * kBlockSide;

/// Stands for "no source in reach": not below (radius + 1)^2, and small enough that a square of
/// (radius + 7)^2 on top does not overflow a byte where bytes are used.
int far_of(int radius) { return (radius + 1) * (radius + 1); }
constexpr int kMaxNarrowRadius = 6;

constexpr int reach_of(int radius) { return std::max(1, (radius + kBlockSide - 1) / kBlockSide); }

template <typename Distance>
DistanceField::Tables<Distance> tables_of(int radius, int reach) {
  DistanceField::Tables<Distance> tables;
  for (int block = -reach; block <= reach; ++block) {
    for (int bits = 0; bits < 256; ++bits) {
      auto& distances = tables.along_x.emplace_back();
      for (int x = 0; x < kBlockSide; ++x) {
        int best = far_of(radius);
        for (int bit = 0; bit < kBlockSide; ++bit) {
          const int offset = block * kBlockSide + bit - x;
          if ((bits >> bit & 1) != 0) best = std::min(best, offset * offset);
        }
        distances[static_cast<std::size_t>(x)] = static_cast<Distance>(best);
      }
    }
  }
  for (int row = -radius; row < kBlockSide + radius; ++row) {
    auto& squares = tables.along_y.emplace_back();
    for (int cell = 0; cell < kPlane; ++cell) {
      const int offset = cell / kBlockSide - row;
      squares[static_cast<std::size_t>(cell)] = static_cast<Distance>(offset * offset);
    }
  }
  return tables;
}

/// Planes of 8x8 distances as vectors.
template <typename Distance>
struct Simd {
  typedef Distance Lanes __attribute__((vector_size(32)));  // a dependent type: no alias
  using Words = std::uint64_t __attribute__((vector_size(32)));
  using Row = std::array<Distance, kBlockSide>;
  static constexpr int kPerVector = 32 / static_cast<int>(sizeof(Distance));
  static constexpr int kPerPlane = kPlane / kPerVector;
  using Plane = Lanes[std::size_t{kPerPlane}];
};

template <typename Lanes>
inline __attribute__((always_inline)) void lower(Lanes& least, const Lanes& other) {
  least = other < least ? other : least;
}

/// A row as often as it fits in a vector.
template <typename Distance>
inline __attribute__((always_inline)) typename Simd<Distance>::Lanes repeated(
    const typename Simd<Distance>::Row& row) {
  std::array<std::uint64_t, sizeof(row) / 8> words;
  std::memcpy(words.data(), row.data(), sizeof(row));
  const typename Simd<Distance>::Words all{words[0], words.back(), words[0], words.back()};
  return std::bit_cast<typename Simd<Distance>::Lanes>(all);
}

/// The lowest bit of every byte that is not zero.
inline std::uint64_t nonzero_bytes(std::uint64_t word) {
  word |= word >> 4;
  word |= word >> 2;
  word |= word >> 1;
  return word & 0x0101010101010101u;
}

/// The cube of blocks around one, and how far sources matter.
struct Surroundings {
  const BlockMask* const* blocks;  ///< (2 reach + 1)^3
  int radius;
};

/// Lowers a plane by the sources of layer z. False when it has none within the radius.
template <int kReach, typename Distance>
inline __attribute__((always_inline)) bool lower_plane(
    const Surroundings& around, int z, const DistanceField::Tables<Distance>& tables, int reach,
    typename Simd<Distance>::Plane& plane) {
  const int side = 2 * reach + 1;
  const BlockMask* const* blocks = around.blocks + ((z >> 3) + reach) * side * side;
  bool any = false;
  for (int block_y = -reach; block_y <= reach; ++block_y, blocks += side) {
    std::array<std::uint64_t, std::size_t{2 * kReach + 1}> words;
    std::uint64_t united = 0;
    for (int block_x = 0; block_x < side; ++block_x) {
      const std::uint64_t word = blocks[block_x]->words[static_cast<std::size_t>(z & 7)];
      words[static_cast<std::size_t>(block_x)] = word;
      united |= word;
    }
    for (std::uint64_t rows = nonzero_bytes(united); rows != 0; rows &= rows - 1) {
      const int shift = std::countr_zero(rows), y = block_y * kBlockSide + shift / 8;
      if (y < -around.radius || y >= kBlockSide + around.radius) continue;
      typename Simd<Distance>::Row row = tables.along_x[words[0] >> shift & 0xFFu];
      for (int block_x = 1; block_x < side; ++block_x) {
        const auto bits = words[static_cast<std::size_t>(block_x)] >> shift & 0xFFu;
        const auto& other = tables.along_x[static_cast<std::size_t>(block_x) * 256 + bits];
        for (std::size_t x = 0; x < kBlockSide; ++x) row[x] = std::min(row[x], other[x]);
      }
      const auto lanes = repeated<Distance>(row);
      const Distance* squares = tables.along_y[static_cast<std::size_t>(y + around.radius)].data();
      for (int i = 0; i < Simd<Distance>::kPerPlane; ++i) {
        const auto square =
            load<typename Simd<Distance>::Lanes>(squares + i * Simd<Distance>::kPerVector);
        lower(plane[i], lanes + square);
      }
      any = true;
    }
  }
  return any;
}

template <int kReach, typename Distance>
inline __attribute__((always_inline)) bool transform(const Surroundings& around, int reach,
                                                     const DistanceField::Tables<Distance>& tables,
                                                     BlockDistances& distances) {
  using Lanes = typename Simd<Distance>::Lanes;
  const int radius = around.radius;
  const Lanes far = Lanes{} + static_cast<Distance>(far_of(radius));
  typename Simd<Distance>::Plane nearest[kBlockSide], plane;
  for (auto& lanes : nearest) std::fill(std::begin(lanes), std::end(lanes), far);
  bool any = false;
  for (int z = -radius; z < kBlockSide + radius; ++z) {
    std::fill(std::begin(plane), std::end(plane), far);
    if (!lower_plane<kReach>(around, z, tables, reach, plane)) continue;
    any = true;
    for (int out = std::max(0, z - radius); out <= std::min(kBlockSide - 1, z + radius); ++out) {
      const Lanes square = Lanes{} + static_cast<Distance>((out - z) * (out - z));
      for (int i = 0; i < Simd<Distance>::kPerPlane; ++i) {
        lower(nearest[out][i], plane[i] + square);
      }
    }
  }
  const auto* flat = reinterpret_cast<const Distance*>(nearest);
  if (any) std::copy(flat, flat + kBlockVoxels, distances.begin());
  return any;
}

MOSBENCH_MULTIARCH bool transform_narrow(const Surroundings& around,
                                         const DistanceField::Tables<std::uint8_t>& tables,
                                         BlockDistances& distances) {
  return transform<1>(around, 1, tables, distances);
}

MOSBENCH_MULTIARCH bool transform_wide(const Surroundings& around, int reach,
                                       const DistanceField::Tables<std::uint16_t>& tables,
                                       BlockDistances& distances) {
  return transform<reach_of(kMaxDistanceRadius)>(around, reach, tables, distances);
}

}  // namespace

MOSBENCH_MULTIARCH BlockMask cells_below(const BlockDistances& distances, std::size_t limit) {
  using Lanes = std::uint16_t __attribute__((vector_size(16)));
  const Lanes bound = Lanes{} + static_cast<std::uint16_t>(limit);
  BlockMask below;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    const std::uint16_t* plane = &distances[z * kPlane];
    std::uint64_t bits = 0;
    for (std::size_t y = 0; y < kBlockSide; y += 2) {
      const auto row = load<Lanes>(plane + y * kBlockSide),
                 next = load<Lanes>(plane + (y + 1) * kBlockSide);
      bits |= std::uint64_t{bits_of(ShortLanes(row < bound), ShortLanes(next < bound))}
              << (y * kBlockSide);
    }
    below.words[z] = bits;
  }
  return below;
}

DistanceField::DistanceField(int radius) : radius_(radius), reach_(reach_of(radius)) {
  if (radius <= kMaxNarrowRadius) {
    narrow_ = tables_of<std::uint8_t>(radius, reach_);
  } else {
    wide_ = tables_of<std::uint16_t>(radius, reach_);
  }
}

bool DistanceField::squared_distances(std::span<const BlockMask* const> sources,
                                      BlockDistances& distances) const {
  const Surroundings around{sources.data(), radius_};
  return narrow_.along_x.empty() ? transform_wide(around, reach_, wide_, distances)
                                 : transform_narrow(around, narrow_, distances);
}

}  // namespace mosbench
