#include "core/tsdf/integration.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "core/base/multiarch.hpp"

namespace mosbench::tsdf {
namespace {

constexpr float kObservedWeight = 1e-6F;

/// Lengths in metres.
struct Limits {
  float min_range, max_range, truncation, half_truncation, voxel_size, near_below;
  float rays_at_1m, max_weight;
};

/// The centre of a block's first voxel in the sensor frame, and the steps from voxel to voxel.
struct BlockPlace {
  std::array<float, 3> first_m;
  std::array<std::array<float, 3>, 3> step_m;  ///< along x, y, z of the map
};

/// Which of a block's voxels the image can change.
enum class Reach : std::uint8_t { kHidden, kFree, kMixed };

struct RowPlace {
  FloatLanes x, y, z;
};

inline __attribute__((always_inline)) RowPlace row_place(const BlockPlace& block, std::size_t row) {
  const auto along_y = static_cast<float>(row & 7), along_z = static_cast<float>(row >> 3);
  const FloatLanes along_x = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto coordinate = [&](std::size_t axis) {
    const float start =
        block.first_m[axis] + (along_y * block.step_m[1][axis] + along_z * block.step_m[2][axis]);
    return start + along_x * block.step_m[0][axis];
  };
  return {coordinate(0), coordinate(1), coordinate(2)};
}

/// The bits of a plane of eight rows, one byte each.
struct SurfaceBits {
  std::uint64_t near_surface, observed;

  static SurfaceBits of(const MapBlock& block, std::size_t z) {
    return {block.near_surface.words[z], block.observed.words[z]};
  }
  void store_to(MapBlock& block, std::size_t z) const {
    block.near_surface.words[z] = near_surface;
    block.observed.words[z] = observed;
  }
};

/// Moves d to `target` and adds to w where `seen`; notes which voxels are near and observed.
inline __attribute__((always_inline)) void add_row(VoxelNumbers& numbers, std::size_t row,
                                                   const FloatLanes& target,
                                                   const FloatLanes& weight, const IntLanes& seen,
                                                   const Limits& limits, SurfaceBits& plane) {
  const auto d = load<FloatLanes>(&numbers.distances_m[row * kLanes]);
  const auto w = load<FloatLanes>(&numbers.weights[row * kLanes]);
  const FloatLanes sum = w + weight;
  const IntLanes counts = seen & (sum > 0.0F);
  const FloatLanes mean = d + (target - d) * (weight / sum);
  const FloatLanes new_d = counts ? mean : d;
  const FloatLanes limited = sum < limits.max_weight ? sum : FloatLanes{} + limits.max_weight;
  const FloatLanes new_w = counts ? limited : w;
  store(new_d, &numbers.distances_m[row * kLanes]);
  store(new_w, &numbers.weights[row * kLanes]);
  plane.near_surface = with_row(plane.near_surface, row & 7, bits_of(new_d < limits.near_below));
  plane.observed = with_row(plane.observed, row & 7, bits_of(new_w > kObservedWeight));
}

/// A row whose voxels all lie in front of all surfaces by more than the truncation distance.
inline __attribute__((always_inline)) void add_free_row(VoxelNumbers& numbers, std::size_t row,
                                                        const BlockPlace& place,
                                                        const Limits& limits, SurfaceBits& plane) {
  const RowPlace p = row_place(place, row);
  const FloatLanes range_sq = (p.x * p.x + p.y * p.y) + p.z * p.z;
  add_row(numbers, row, FloatLanes{} + limits.truncation, limits.rays_at_1m / range_sq,
          IntLanes{} == 0, limits, plane);
}

MOSBENCH_MULTIARCH void add_free(MapBlock& block, VoxelNumbers& numbers, const BlockPlace& place,
                                 const Limits& limits) {
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    SurfaceBits plane = SurfaceBits::of(block, z);
    for (std::size_t y = 0; y < kBlockSide; ++y) {
      add_free_row(numbers, z * kBlockSide + y, place, limits, plane);
    }
    plane.store_to(block, z);
  }
}

/// Two pixels side by side, as one number to be loaded.
inline __attribute__((always_inline)) double pair_at(const float* pixels) {
  typedef double Unaligned __attribute__((may_alias, aligned(1)));
  return *reinterpret_cast<const Unaligned*>(pixels);
}

struct PixelPairs {
  FloatLanes left, right;
};

/// Returns the pixels at eight offsets, and those to the right of them.
inline __attribute__((always_inline)) PixelPairs pairs_at(const float* pixels,
                                                          const LaneArray& offsets) {
  using Pairs = double __attribute__((vector_size(32)));
  const auto pair = [&](std::size_t lane) { return pair_at(pixels + offsets[lane]); };
  const auto some = reinterpret_cast<FloatLanes>(Pairs{pair(0), pair(1), pair(4), pair(5)});
  const auto others = reinterpret_cast<FloatLanes>(Pairs{pair(2), pair(3), pair(6), pair(7)});
  return {__builtin_shufflevector(some, others, 0, 2, 8, 10, 4, 6, 12, 14),
          __builtin_shufflevector(some, others, 1, 3, 9, 11, 5, 7, 13, 15)};
}

inline __attribute__((always_inline)) FourPixels pixels_at(const RangeImage& image,
                                                           const IntLanes& row,
                                                           const IntLanes& column) {
  LaneArray offsets;
  store(row * image.columns + column, offsets);
  const PixelPairs top = pairs_at(image.ranges_m.data(), offsets);
  const PixelPairs bottom = pairs_at(image.ranges_m.data() + image.columns, offsets);
  return {top.left, top.right, bottom.left, bottom.right};
}

/// A row that the image may change.
inline __attribute__((always_inline)) void add_mixed_row(VoxelNumbers& numbers, std::size_t row,
                                                         const BlockPlace& place,
                                                         const RangeImage& image,
                                                         const ImageProjection& projection,
                                                         const Limits& limits, SurfaceBits& plane) {
  const RowPlace p = row_place(place, row);
  const FloatLanes flat_sq = p.x * p.x + p.y * p.y;
  const FloatLanes range_sq = flat_sq + p.z * p.z;
  const FloatLanes range = sqrt_of(range_sq);
  const ImageProjection::Place at = projection.place(p.x, p.y, p.z, sqrt_of(flat_sq));
  const IntLanes inside = (range >= limits.min_range) & (range <= limits.max_range) &
                          (at.row >= 0.0F) & (at.row <= projection.last_row) & (at.column > 0.0F) &
                          (at.column < projection.last_column);
  if (bits_of(inside) == 0) return;
  const FloatLanes h = inside ? at.row : FloatLanes{}, w = inside ? at.column : FloatLanes{};
  const IntLanes whole_h = __builtin_convertvector(h, IntLanes);
  const IntLanes whole_w = __builtin_convertvector(w, IntLanes);
  const FloatLanes depth = depth_between(
      pixels_at(image, whole_h, whole_w), h - __builtin_convertvector(whole_h, FloatLanes),
      w - __builtin_convertvector(whole_w, FloatLanes), limits.half_truncation);
  const FloatLanes sdf = depth - range;
  const IntLanes seen = inside & (sdf >= -limits.truncation);
  if (bits_of(seen) == 0) return;
  const FloatLanes full = limits.rays_at_1m / range_sq;
  const FloatLanes behind =
      full * (limits.truncation + sdf) / (limits.truncation - limits.voxel_size);
  const FloatLanes weight =
      sdf < -limits.voxel_size ? (behind > 0.0F ? behind : FloatLanes{}) : full;
  const FloatLanes target = sdf < limits.truncation ? sdf : FloatLanes{} + limits.truncation;
  add_row(numbers, row, target, weight, seen, limits, plane);
}

/// The states of the eight cubes that a cube is cut into, x fastest.
using EightReaches = std::array<Reach, 8>;

MOSBENCH_MULTIARCH void add_mixed(MapBlock& block, VoxelNumbers& numbers, const BlockPlace& place,
                                  const EightReaches& parts, const RangeImage& image,
                                  const ImageProjection& projection, const Limits& limits) {
  for (std::size_t z = 0; z < kBlockSide; ++z) {
    SurfaceBits plane = SurfaceBits::of(block, z);
    for (std::size_t y = 0; y < kBlockSide; ++y) {
      const std::size_t row = z * kBlockSide + y, part = (z >> 2) * 4 + (y >> 2) * 2;
      if (parts[part] != Reach::kMixed && parts[part] == parts[part + 1]) {
        if (parts[part] == Reach::kFree) add_free_row(numbers, row, place, limits, plane);
        continue;
      }
      add_mixed_row(numbers, row, place, image, projection, limits, plane);
    }
    plane.store_to(block, z);
  }
}

/// Bounds of the depths over cubes of voxels.
class Surroundings {
 public:
  Surroundings(const Depths& depths, const Limits& limits)
      : bounds_(depths.image), projection_(depths.sensor), limits_(limits) {}

  /// Tells from the balls of `radius_m` around the centres of eight cubes' voxels.
  MOSBENCH_MULTIARCH EightReaches reaches_of(const std::array<std::array<float, 8>, 3>& centres_m,
                                             float radius_m) const {
    const auto x = load<FloatLanes>(centres_m[0].data()), y = load<FloatLanes>(centres_m[1].data()),
               z = load<FloatLanes>(centres_m[2].data());
    const FloatLanes flat_sq = x * x + y * y, range_sq = flat_sq + z * z;
    const FloatLanes range = sqrt_of(range_sq);
    const ImageProjection::Place at = projection_.place(x, y, z, sqrt_of(flat_sq));
    // asin(s) <= s / sqrt(1 - s^2); where the sensor is inside, everything may be met.
    const auto half_angle = [&](const FloatLanes& distance_sq) {
      const FloatLanes rest = distance_sq - radius_m * radius_m;
      const FloatLanes positive = rest > 0.0F ? rest : FloatLanes{} + 1e-12F;
      return radius_m * kTurnsPerRadian / sqrt_of(positive);
    };
    const FloatLanes rows = half_angle(range_sq) * projection_.rows_per_turn + kSlackPixels;
    const FloatLanes columns = half_angle(flat_sq) * projection_.columns + kSlackPixels;
    Balls balls;
    store(range - (radius_m + kSlack_m), balls.nearest_m.data());
    store(range + (radius_m + kSlack_m), balls.farthest_m.data());
    store(at.row - rows, balls.low_row.data());
    store(at.row + rows, balls.high_row.data());
    store(at.column - columns, balls.low_column.data());
    store(at.column + columns, balls.high_column.data());
    EightReaches reaches;
    for (std::size_t i = 0; i < kLanes; ++i) reaches[i] = reach_of(balls, i);
    return reaches;
  }

 private:
  // Beyond rounding of single precision.
  static constexpr float kSlack_m = 2e-3F, kSlackPixels = 0.02F;
  static constexpr float kTurnsPerRadian = 0.15915494F;

  struct Balls {
    std::array<float, kLanes> nearest_m, farthest_m, low_row, high_row, low_column, high_column;
  };

  Reach reach_of(const Balls& balls, std::size_t i) const {
    const float nearest_m = balls.nearest_m[i], farthest_m = balls.farthest_m[i];
    if (nearest_m > limits_.max_range || farthest_m < limits_.min_range) return Reach::kHidden;
    const float low_row = balls.low_row[i], high_row = balls.high_row[i];
    const float low_column = balls.low_column[i], high_column = balls.high_column[i];
    // Across the seam columns are counted from both ends, and above the sensor from anywhere.
    if (!(low_column >= 0 && high_column < projection_.last_column)) return Reach::kMixed;
    if (high_row < 0 || low_row > projection_.last_row) return Reach::kHidden;
    const DepthBounds::Bounds depth =
        bounds_.within(static_cast<int>(std::max(0.0F, low_row)),
                       static_cast<int>(std::min(projection_.last_row, high_row)),
                       static_cast<int>(low_column), static_cast<int>(high_column));
    if (depth.greatest_m < nearest_m - limits_.truncation) return Reach::kHidden;
    const bool all_in_view = low_row >= 0 && high_row <= projection_.last_row && low_column > 0 &&
                             nearest_m >= limits_.min_range && farthest_m <= limits_.max_range;
    if (all_in_view && depth.least_m >= farthest_m + limits_.truncation) return Reach::kFree;
    return Reach::kMixed;
  }

  DepthBounds bounds_;
  ImageProjection projection_;
  const Limits& limits_;
};

/// Returns the centres of the eight cubes with so many voxels along each edge that lie from a first
/// voxel on, whose centre and steps are given.
std::array<std::array<float, 8>, 3> centres_of_parts(const BlockPlace& place, int side_voxels) {
  std::array<std::array<float, 8>, 3> centres_m{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < 8; ++part) {
      const auto along = [&](std::size_t bit) {
        return static_cast<float>((part >> bit & 1) * static_cast<std::size_t>(side_voxels)) +
               static_cast<float>(side_voxels - 1) / 2;
      };
      centres_m[axis][part] = place.first_m[axis] + along(0) * place.step_m[0][axis] +
                              along(1) * place.step_m[1][axis] + along(2) * place.step_m[2][axis];
    }
  }
  return centres_m;
}

/// Returns the radius of the ball around the voxels' centres of a cube.
float ball_radius_m(int side_voxels, double voxel_size_m) {
  return static_cast<float>((side_voxels - 1) / 2.0 * std::numbers::sqrt3 * voxel_size_m);
}

}  // namespace

void integrate(TsdfMap& map, std::span<const std::uint32_t> slots, const VoxelGrid& grid,
               const Depths& depths, const Config& config, ThreadPool& pool) {
  const Limits limits{
      .min_range = static_cast<float>(config.min_range_m),
      .max_range = static_cast<float>(config.max_range_m),
      .truncation = config.truncation_m(),
      .half_truncation = 0.5F * config.truncation_m(),
      .voxel_size = static_cast<float>(config.voxel_size_m),
      .near_below = map.near_below_m,
      .rays_at_1m = static_cast<float>(depths.sensor.rays_per_voxel_at_1m(config.voxel_size_m)),
      .max_weight = static_cast<float>(config.max_weight)};
  const Surroundings surroundings(depths, limits);
  const Eigen::Matrix3d turned = depths.map_from_sensor.linear().transpose();
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(config.voxel_size_m / 2);
  BlockPlace steps{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t along = 0; along < 3; ++along) {
      steps.step_m[along][axis] = static_cast<float>(
          turned(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(along)) *
          config.voxel_size_m);
    }
  }
  const auto place_of = [&](std::uint32_t slot) {
    const Eigen::Vector3d corner_m = grid.corner_m(voxel_at(map.blocks.index_of(slot), 0));
    const Eigen::Vector3f first =
        (turned * (corner_m + half - depths.map_from_sensor.translation())).cast<float>();
    BlockPlace place = steps;
    place.first_m = {first.x(), first.y(), first.z()};
    return place;
  };
  const float block_radius_m = ball_radius_m(kBlockSide, config.voxel_size_m);
  const float part_radius_m = ball_radius_m(kBlockSide / 2, config.voxel_size_m);
  std::vector<EightReaches> reaches(slots.size() / 8);
  pool.for_ranges(reaches.size(), 8, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t wide = begin; wide < end; ++wide) {
      reaches[wide] = surroundings.reaches_of(
          centres_of_parts(place_of(slots[wide * 8]), kBlockSide), block_radius_m);
    }
  });
  for (std::size_t i = 0; i < slots.size(); ++i) {
    MapBlock& block = map.blocks[slots[i]];
    if (reaches[i / 8][i % 8] != Reach::kHidden && block.numbers == kNoSlot) map.add_numbers(block);
  }
  const ImageProjection projection(depths.sensor);
  pool.for_ranges(slots.size(), 16, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const Reach reach = reaches[i / 8][i % 8];
      if (reach == Reach::kHidden) continue;
      MapBlock& block = map.blocks[slots[i]];
      const BlockPlace place = place_of(slots[i]);
      VoxelNumbers& numbers = map.numbers[block.numbers];
      if (reach == Reach::kFree) {
        add_free(block, numbers, place, limits);
        continue;
      }
      const EightReaches parts =
          surroundings.reaches_of(centres_of_parts(place, kBlockSide / 2), part_radius_m);
      add_mixed(block, numbers, place, parts, depths.image, projection, limits);
    }
  });
}

}  // namespace mosbench::tsdf
