#include "core/voxel/distance_field.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

namespace mosbench {
namespace {

constexpr int kPlane = kBlockSide * kBlockSide;

/// A square of (radius + 7)^2 on top of far_squared does not overflow a byte.
constexpr int kMaxNarrowRadius = 6;

constexpr int reach_of(int radius) { return std::max(1, (radius + kBlockSide - 1) / kBlockSide); }

template <typename Distance>
DistanceField::Tables<Distance> tables_of(int radius, int reach) {
  DistanceField::Tables<Distance> tables;
  for (int block = -reach; block <= reach; ++block) {
    for (int bits = 0; bits < 256; ++bits) {
      auto& distances = tables.along_x.emplace_back();
      for (int x = 0; x < kBlockSide; ++x) {
        int best = far_squared(radius);
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
  /// The type of a comparison's result, by a name that compilers agree on.
  using Flags = std::conditional_t<sizeof(Distance) == 1, ByteFlags, ShortFlags>;
  using Row = std::array<Distance, kBlockSide>;
  static constexpr int kPerVector = 32 / static_cast<int>(sizeof(Distance));
  static constexpr int kPerPlane = kPlane / kPerVector;
  struct Plane {
    Lanes lanes[std::size_t{kPerPlane}];
  };
  /// No source in reach of any cell.
  static Plane far_plane(const Lanes& far) {
    Plane plane{};
    for (Lanes& lanes : plane.lanes) lanes = far;
    return plane;
  }
  static Lanes far_lanes(int radius) {
    return Lanes{} + static_cast<Distance>(far_squared(radius));
  }
};

template <typename Lanes>
inline __attribute__((always_inline)) void lower(Lanes& least, const Lanes& other) {
  least = other < least ? other : least;
}

/// Repeats a row as often as it fits into a vector.
template <typename Distance>
inline __attribute__((always_inline)) typename Simd<Distance>::Lanes repeated(
    const typename Simd<Distance>::Row& row) {
  std::array<std::uint64_t, sizeof(row) / 8> words;
  std::memcpy(words.data(), row.data(), sizeof(row));
  const typename Simd<Distance>::Words all{words[0], words.back(), words[0], words.back()};
  return std::bit_cast<typename Simd<Distance>::Lanes>(all);
}

/// Bit i is set where byte i is not zero.
inline std::uint64_t nonzero_bytes(std::uint64_t word) {
  word |= word >> 4;
  word |= word >> 2;
  word |= word >> 1;
  return (word & kFirstColumn) * 0x0102040810204080u >> 56;
}

/// The cube of blocks around a block, and how far sources matter.
struct Surroundings {
  const SourceBlock* const* blocks;  ///< (2 reach + 1)^3
  int radius, reach;

  int side() const { return 2 * reach + 1; }
};

/// Returns a word whose lowest `count` bits are set, 1 to 64.
std::uint64_t lowest_bits(int count) { return ~std::uint64_t{0} >> (64 - count); }

/// Rows or layers of a block and of `radius` on either side.
int side_around(int radius) { return kBlockSide + 2 * radius; }

/// Bit y + radius is set where layer `z` of a square of blocks has a source in row y.
inline __attribute__((always_inline)) std::uint64_t rows_with_source(
    const Surroundings& around, const SourceBlock* const* blocks, int z) {
  std::uint64_t rows = 0;
  for (int block_y = -around.reach; block_y <= around.reach; ++block_y) {
    std::uint64_t united = 0;
    for (int block_x = 0; block_x < around.side(); ++block_x) united |= (*blocks++)->rows;
    const std::uint64_t bits = united >> (8 * z) & 0xFFu;
    const int first = block_y * kBlockSide + around.radius;
    rows |= first < 0 ? bits >> -first : bits << first;
  }
  return rows & lowest_bits(side_around(around.radius));
}

/// Squared distances from the cells of a plane to the sources of layer z. False when there are none
/// within the radius.
template <typename Distance>
inline __attribute__((always_inline)) bool fill_plane(const Surroundings& around, int z,
                                                      const DistanceField::Tables<Distance>& tables,
                                                      const typename Simd<Distance>::Lanes& far,
                                                      typename Simd<Distance>::Plane& plane) {
  using Lanes = typename Simd<Distance>::Lanes;
  const int side = around.side();
  const SourceBlock* const* blocks = around.blocks + ((z >> 3) + around.reach) * side * side;
  std::uint64_t rows = rows_with_source(around, blocks, z & 7);
  if (rows == 0) return false;
  const auto layer = static_cast<std::size_t>(z & 7);
  auto least = Simd<Distance>::far_plane(far);
  for (; rows != 0; rows &= rows - 1) {
    const int place = std::countr_zero(rows), y = place - around.radius;
    const SourceBlock* const* block = blocks + ((y >> 3) + around.reach) * side;
    const int shift = (y & 7) * 8;
    typename Simd<Distance>::Row row = tables.along_x[(*block)->mask.words[layer] >> shift & 0xFFu];
    for (std::size_t block_x = 1; block_x < static_cast<std::size_t>(side); ++block_x) {
      const auto bits = block[block_x]->mask.words[layer] >> shift & 0xFFu;
      const auto& other = tables.along_x[block_x * 256 + bits];
      for (std::size_t x = 0; x < kBlockSide; ++x) row[x] = std::min(row[x], other[x]);
    }
    const auto lanes = repeated<Distance>(row);
    const Distance* squares = tables.along_y[static_cast<std::size_t>(place)].data();
    for (int i = 0; i < Simd<Distance>::kPerPlane; ++i) {
      lower(least.lanes[i], lanes + load<Lanes>(squares + i * Simd<Distance>::kPerVector));
    }
  }
  plane = least;
  return true;
}

/// Layers of a column of blocks, counted from `radius` below a block.
struct LayersAround {
  ColumnDistances::Layers& layers;
  int first;  ///< place of the lowest one

  // As many places as a word has bits, so that rotating a word rotates the places.
  static_assert(ColumnDistances::kMaxLayers == 64);
  int place(int layer) const { return (first + layer) & (ColumnDistances::kMaxLayers - 1); }
  std::uint64_t known() const { return std::rotr(layers.known, first); }
  std::uint64_t filled() const { return std::rotr(layers.filled, first); }
};

/// Computes those of the `needed` layers that are not known.
template <typename Distance>
inline __attribute__((always_inline)) void fill_layers(
    const Surroundings& around, const DistanceField::Tables<Distance>& tables, std::uint64_t needed,
    const LayersAround& column) {
  auto* planes = reinterpret_cast<typename Simd<Distance>::Plane*>(column.layers.planes.data());
  const auto far = Simd<Distance>::far_lanes(around.radius);
  for (std::uint64_t left = needed & ~column.known(); left != 0; left &= left - 1) {
    const int layer = std::countr_zero(left), place = column.place(layer),
              z = layer - around.radius;
    const bool filled = fill_plane(around, z, tables, far, planes[place]);
    column.layers.filled |= std::uint64_t{filled} << place;
  }
  column.layers.known |= std::rotl(needed, column.first);
}

/// The lower envelope along z for one layer of the block. Returns its near cells.
template <typename Distance>
inline __attribute__((always_inline)) std::uint64_t envelope_at(const LayersAround& column, int z,
                                                                int radius,
                                                                std::uint16_t* distances) {
  using Lanes = typename Simd<Distance>::Lanes;
  using Plane = typename Simd<Distance>::Plane;
  const auto* planes = reinterpret_cast<const Plane*>(column.layers.planes.data());
  const Lanes far = Simd<Distance>::far_lanes(radius);
  Plane least = Simd<Distance>::far_plane(far);
  // Layer z lies at z + radius, and those within the radius at z to z + 2 radius.
  const std::uint64_t within = lowest_bits(2 * radius + 1);
  for (std::uint64_t left = column.filled() >> z & within; left != 0; left &= left - 1) {
    const int i = std::countr_zero(left), offset = i - radius;
    const Lanes square = Lanes{} + static_cast<Distance>(offset * offset);
    const Plane& plane = planes[column.place(z + i)];
    for (int j = 0; j < Simd<Distance>::kPerPlane; ++j)
      lower(least.lanes[j], plane.lanes[j] + square);
  }
  std::uint64_t near = 0;
  for (int j = 0; j < Simd<Distance>::kPerPlane; ++j) {
    near |= std::uint64_t{bits_of(typename Simd<Distance>::Flags(least.lanes[j] < far))}
            << (j * Simd<Distance>::kPerVector);
  }
  const auto* flat = reinterpret_cast<const Distance*>(&least);
  std::copy(flat, flat + kPlane, distances);
  return near;
}

template <typename Distance>
inline __attribute__((always_inline)) void transform(const Surroundings& around,
                                                     const DistanceField::Tables<Distance>& tables,
                                                     const BlockMask& wanted,
                                                     const LayersAround& column,
                                                     BlockDistances& distances) {
  std::uint64_t needed = 0;
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    if (wanted.words[z] != 0) needed |= lowest_bits(2 * around.radius + 1) << z;
  }
  fill_layers(around, tables, needed, column);
  for (int z = 0; z < kBlockSide; ++z) {
    std::uint64_t& near = distances.near.words[static_cast<std::size_t>(z)];
    near = 0;
    if (wanted.words[static_cast<std::size_t>(z)] == 0) continue;
    near = envelope_at<Distance>(column, z, around.radius,
                                 &distances.squared[static_cast<std::size_t>(z) * kPlane]);
  }
}

MOSBENCH_MULTIARCH void transform_narrow(const Surroundings& around,
                                         const DistanceField::Tables<std::uint8_t>& tables,
                                         const BlockMask& wanted, const LayersAround& column,
                                         BlockDistances& distances) {
  const Surroundings cube{around.blocks, around.radius, 1};  // the compiler unrolls it
  transform(cube, tables, wanted, column, distances);
}

MOSBENCH_MULTIARCH void transform_wide(const Surroundings& around,
                                       const DistanceField::Tables<std::uint16_t>& tables,
                                       const BlockMask& wanted, const LayersAround& column,
                                       BlockDistances& distances) {
  transform(around, tables, wanted, column, distances);
}

}  // namespace

void SourceBlock::add(const BlockMask& sources) {
  mask = mask | sources;
  for (std::size_t z = 0; z < kBlockSide; ++z) rows |= nonzero_bytes(sources.words[z]) << (8 * z);
}

DistanceField::DistanceField(int radius) : radius_(radius), reach_(reach_of(radius)) {
  if (radius <= kMaxNarrowRadius) {
    narrow_ = tables_of<std::uint8_t>(radius, reach_);
  } else {
    wide_ = tables_of<std::uint16_t>(radius, reach_);
  }
}

void ColumnDistances::find(const BlockIndex& block, const BlockMask& wanted,
                           std::span<const SourceBlock* const> sources, BlockDistances& distances) {
  const Surroundings around{sources.data(), field_.radius_, field_.reach_};
  const auto lowest = static_cast<std::uint32_t>(block.z * kBlockSide - around.radius);
  const LayersAround column{layers_, static_cast<int>(lowest % kMaxLayers)};
  const int up = last_ && last_->x == block.x && last_->y == block.y ? block.z - last_->z : 0;
  const int kept = side_around(around.radius) - up * kBlockSide;
  // Slots of layers outside this block's reach are reused for the new layers.
  const std::uint64_t shared = up > 0 && kept > 0 ? lowest_bits(kept) : 0;
  layers_.known &= std::rotl(shared, column.first);
  layers_.filled &= layers_.known;
  last_ = block;
  if (field_.narrow_.along_x.empty()) {
    transform_wide(around, field_.wide_, wanted, column, distances);
  } else {
    transform_narrow(around, field_.narrow_, wanted, column, distances);
  }
}

SourceGrid::SourceGrid(std::span<const VoxelSet* const> sets, std::span<const BlockIndex> blocks,
                       int margin) {
  if (blocks.empty()) return;
  std::array<std::int32_t, 3> high{blocks[0].x, blocks[0].y, blocks[0].z};
  low_ = high;
  for (const BlockIndex& block : blocks) {
    const std::array<std::int32_t, 3> c{block.x, block.y, block.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], c[axis]);
      high[axis] = std::max(high[axis], c[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis] -= margin;
    high[axis] += margin;
    sides_[axis] = static_cast<std::size_t>(high[axis] - low_[axis] + 1);
  }
  slots_.assign(sides_[0] * sides_[1] * sides_[2], kEmpty);
  sources_.emplace_back();
  for (const VoxelSet* set : sets) {
    for (std::size_t i = 0; i < set->block_count(); ++i) {
      const BlockIndex& block = set->blocks[i];
      if (block.x < low_[0] || block.y < low_[1] || block.z < low_[2] || block.x > high[0] ||
          block.y > high[1] || block.z > high[2]) {
        continue;
      }
      std::uint32_t& slot = slots_[position(block)];
      if (slot == kEmpty) {
        slot = static_cast<std::uint32_t>(sources_.size());
        sources_.emplace_back();
      }
      sources_[slot].add(set->masks[i]);
    }
  }
}

}  // namespace mosbench
