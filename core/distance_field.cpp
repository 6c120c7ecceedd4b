#include "core/distance_field.hpp"

#include <algorithm>
#include <limits>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

constexpr int kMaxNarrowRadius = 14;
constexpr int kMaxSide = kBlockSide + 2 * kMaxHalo;

template <typename Distance>
inline constexpr Distance kFar = std::numeric_limits<Distance>::max();

template <typename Distance>
std::vector<std::array<Distance, kBlockSide>> row_table(int radius) {
  std::vector<std::array<Distance, kBlockSide>> table;
  const int pieces = (kBlockSide + 2 * radius + 7) / 8;
  for (int piece = 0; piece < pieces; ++piece) {
    for (int bits = 0; bits < 256; ++bits) {
      auto& distances = table.emplace_back();
      for (int x = 0; x < kBlockSide; ++x) {
        int best = std::numeric_limits<int>::max();
        for (int bit = 0; bit < 8; ++bit) {
          const int offset = piece * 8 + bit - radius - x;
          if ((bits >> bit & 1) != 0 && std::abs(offset) <= radius) {
            best = std::min(best, offset * offset);
          }
        }
        distances[static_cast<std::size_t>(x)] =
            best == std::numeric_limits<int>::max() ? kFar<Distance> : static_cast<Distance>(best);
      }
    }
  }
  return table;
}

/// out[i] = min(out[i], in[i] + square), saturating at kFar.
template <typename Distance>
inline void lower(Distance* out, const Distance* in, std::size_t count, int square) {
  const auto highest = static_cast<Distance>(kFar<Distance> - square);
  for (std::size_t i = 0; i < count; ++i) {
    const Distance sum = static_cast<Distance>(std::min(in[i], highest) + square);
    out[i] = std::min(out[i], sum);
  }
}

template <typename Distance>
inline __attribute__((always_inline)) void transform(const HaloRows& sources,
                                                     const std::array<Distance, kBlockSide>* table,
                                                     BlockDistances& distances) {
  constexpr std::size_t kPlane = kBlockSide * kBlockSide;
  const int radius = sources.radius, side = sources.side;
  alignas(64) std::array<Distance, kPlane * kBlockSide> nearest;
  nearest.fill(kFar<Distance>);
  alignas(64) std::array<Distance, kMaxSide * kBlockSide> rows;
  alignas(64) std::array<Distance, kPlane> plane;
  for (int z = 0; z < side; ++z) {
    std::uint64_t any = 0;
    for (int y = 0; y < side; ++y) any |= sources.row(z, y);
    if (any == 0) continue;
    for (int y = 0; y < side; ++y) {
      Distance* row = &rows[static_cast<std::size_t>(y) * kBlockSide];
      std::fill_n(row, kBlockSide, kFar<Distance>);
      const std::array<Distance, kBlockSide>* piece = table;
      for (std::uint64_t bits = sources.row(z, y); bits != 0; bits >>= 8, piece += 256) {
        lower(row, piece[bits & 0xFFu].data(), kBlockSide, 0);
      }
    }
    plane.fill(kFar<Distance>);
    for (int offset = -radius; offset <= radius; ++offset) {
      lower(plane.data(), &rows[static_cast<std::size_t>(radius + offset) * kBlockSide], kPlane,
            offset * offset);
    }
    for (int out = std::max(0, z - 2 * radius); out <= std::min(kBlockSide - 1, z); ++out) {
      const int offset = out + radius - z;
      lower(&nearest[static_cast<std::size_t>(out) * kPlane], plane.data(), kPlane,
            offset * offset);
    }
  }
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    distances[i] = nearest[i] == kFar<Distance> ? kFarAway : nearest[i];
  }
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
