#include "core/distance_field.hpp"

#include <algorithm>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kPlane = kBlockSide * kBlockSide;

/// Stands for "no source in reach": not below (radius + 1)^2, and small enough that a square of
/// (radius + 7)^2 on top does not overflow a byte where bytes are used.
int far_of(int radius) { return (radius + 1) * (radius + 1); }
constexpr int kMaxNarrowRadius = 6;

template <typename Distance>
std::vector<std::array<Distance, kBlockSide>> row_table(int radius) {
  std::vector<std::array<Distance, kBlockSide>> table;
  const int pieces = (kBlockSide + 2 * radius + 7) / 8;
  for (int piece = 0; piece < pieces; ++piece) {
    for (int bits = 0; bits < 256; ++bits) {
      auto& distances = table.emplace_back();
      for (int x = 0; x < kBlockSide; ++x) {
        int best = far_of(radius);
        for (int bit = 0; bit < 8; ++bit) {
          const int offset = piece * 8 + bit - radius - x;
          if ((bits >> bit & 1) != 0) best = std::min(best, offset * offset);
        }
        distances[static_cast<std::size_t>(x)] = static_cast<Distance>(best);
      }
    }
  }
  return table;
}

/// Squared distances of the eight cells of a row along x.
template <typename Distance>
inline std::array<Distance, kBlockSide> along_x(std::uint64_t bits,
                                                const std::array<Distance, kBlockSide>* piece) {
  std::array<Distance, kBlockSide> nearest = piece[bits & 0xFFu];
  for (bits >>= 8, piece += 256; bits != 0; bits >>= 8, piece += 256) {
    const std::array<Distance, kBlockSide>& other = piece[bits & 0xFFu];
    for (std::size_t i = 0; i < kBlockSide; ++i) nearest[i] = std::min(nearest[i], other[i]);
  }
  return nearest;
}

/// plane[y][x] = min(plane[y][x], row[x] + (y - row's y)^2).
template <typename Distance>
inline void lower_plane(Distance* __restrict plane, const std::array<Distance, kBlockSide>& row,
                        int row_y) {
  for (int y = 0; y < kBlockSide; ++y) {
    const auto square = static_cast<Distance>((y - row_y) * (y - row_y));
    for (int x = 0; x < kBlockSide; ++x) {
      const auto sum = static_cast<Distance>(row[static_cast<std::size_t>(x)] + square);
      plane[y * kBlockSide + x] = std::min(plane[y * kBlockSide + x], sum);
    }
  }
}

/// nearest[i] = min(nearest[i], plane[i] + square).
template <typename Distance>
inline void lower_block(Distance* __restrict nearest, const Distance* __restrict plane,
                        Distance square) {
  for (std::size_t i = 0; i < kPlane; ++i) {
    nearest[i] = std::min(nearest[i], static_cast<Distance>(plane[i] + square));
  }
}

template <typename Distance>
inline __attribute__((always_inline)) void transform(const HaloRows& sources,
                                                     const std::array<Distance, kBlockSide>* table,
                                                     BlockDistances& distances) {
  const int radius = sources.radius, side = sources.side;
  const auto far = static_cast<Distance>(far_of(radius));
  alignas(64) std::array<Distance, kPlane * kBlockSide> nearest;
  nearest.fill(far);
  alignas(64) std::array<Distance, kPlane> plane;
  for (int z = 0; z < side; ++z) {
    plane.fill(far);
    bool any = false;
    for (int y = 0; y < side; ++y) {
      const std::uint64_t bits = sources.row(z, y);
      if (bits == 0) continue;
      lower_plane(plane.data(), along_x(bits, table), y - radius);
      any = true;
    }
    if (!any) continue;
    for (int out = std::max(0, z - 2 * radius); out <= std::min(kBlockSide - 1, z); ++out) {
      const int offset = out + radius - z;
      lower_block(&nearest[static_cast<std::size_t>(out) * kPlane], plane.data(),
                  static_cast<Distance>(offset * offset));
    }
  }
  std::copy(nearest.begin(), nearest.end(), distances.begin());
}

MOSBENCH_MULTIARCH void transform_narrow(const HaloRows& sources,
                                         const std::array<std::uint8_t, kBlockSide>* table,
                                         BlockDistances& distances) {
  transform(sources, table, distances);
}

MOSBENCH_MULTIARCH void transform_wide(const HaloRows& sources,
                                       const std::array<std::uint16_t, kBlockSide>* table,
                                       BlockDistances& distances) {
  transform(sources, table, distances);
}

}  // namespace

MOSBENCH_MULTIARCH BlockMask cells_below(const BlockDistances& distances, std::size_t limit) {
  BlockMask below;
  const auto bound = static_cast<std::uint16_t>(limit);
  for (std::size_t row = 0; row < kBlockVoxels / kBlockSide; ++row) {
    std::uint16_t bits = 0;
    for (std::size_t x = 0; x < kBlockSide; ++x) {
      const bool is_below = distances[row * kBlockSide + x] < bound;
      bits |= static_cast<std::uint16_t>(is_below ? 1u << x : 0u);
    }
    below.words[row / kBlockSide] |= std::uint64_t{bits} << (row % kBlockSide * kBlockSide);
  }
  return below;
}

DistanceField::DistanceField(int radius) : radius_(radius) {
  if (radius <= kMaxNarrowRadius) {
    narrow_ = row_table<std::uint8_t>(radius);
  } else {
    wide_ = row_table<std::uint16_t>(radius);
  }
}

void DistanceField::squared_distances(const HaloRows& sources, BlockDistances& distances) const {
  if (!narrow_.empty()) {
    transform_narrow(sources, narrow_.data(), distances);
  } else {
    transform_wide(sources, wide_.data(), distances);
  }
}

}  // namespace mosbench
