#include "core/voxel/voxelize.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

namespace mosbench {
namespace {

constexpr double kReachFromOrigin = 1 << 23;
constexpr double kReachFromSensor = 1 << 19;

// Instead of a coordinate x, points without a voxel have a reason.
constexpr std::int32_t kTooNear = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kNonfinite = kTooNear + 1;
constexpr std::int32_t kOverflow = kTooNear + 2;

struct Projection {
  double rotation[9], translation[3], origin[3];
  double sensor_m[3], sensor_voxel[3];  ///< where the rays start
  double voxel_size_m, min_range_sq_m2;
};

constexpr std::size_t kChunk = 512;
struct ProjectedChunk {
  std::array<std::int32_t, kChunk> x, y, z;
};

using Doubles = double __attribute__((vector_size(32)));
using Floats = float __attribute__((vector_size(16)));
using Ints = std::int32_t __attribute__((vector_size(16)));
using Choice = std::int64_t __attribute__((vector_size(32)));

#if defined(__FAST_MATH__)
#error "sums must be rounded one by one, as written"
#endif
static_assert(FLT_EVAL_METHOD == 0, "doubles must be rounded to doubles (x86: SSE2)");

/// Computes std::floor of numbers below 2^51 by adding a number whose last bit is worth one. Larger
/// ones, far beyond any grid, are returned unchanged.
inline __attribute__((always_inline)) Doubles floor_of(const Doubles& lanes) {
  constexpr double kWhole = 6755399441055744.0;  // 1.5 * 2^52
  const Doubles nearest = (lanes + kWhole) - kWhole;
  const Doubles floor = nearest > lanes ? nearest - 1.0 : nearest;
  return magnitude(lanes) < 2251799813685248.0 ? floor : lanes;
}

inline __attribute__((always_inline)) Doubles greatest(const Doubles& a, const Doubles& b,
                                                       const Doubles& c) {
  const Doubles ab = a > b ? a : b;
  return ab > c ? ab : c;
}

/// P_M = T_{M->S} P_S and P'_M = floor(P_M / Delta) (paper, III) of four points, written to the
/// chunk from `first` on.
inline __attribute__((always_inline)) void project_four(const Point* points,
                                                        const Projection& projection,
                                                        std::size_t first, ProjectedChunk& chunk) {
  static_assert(sizeof(Point) == sizeof(Floats));
  const double* r = projection.rotation;
  const double* t = projection.translation;
  const double* s = projection.sensor_voxel;
  const double* o = projection.sensor_m;
  const auto p0 = load<Floats>(points), p1 = load<Floats>(points + 1),
             p2 = load<Floats>(points + 2), p3 = load<Floats>(points + 3);
  const Floats xy01 = __builtin_shufflevector(p0, p1, 0, 4, 1, 5);
  const Floats xy23 = __builtin_shufflevector(p2, p3, 0, 4, 1, 5);
  const Floats z01 = __builtin_shufflevector(p0, p1, 2, 6, 3, 7);
  const Floats z23 = __builtin_shufflevector(p2, p3, 2, 6, 3, 7);
  const auto x = __builtin_convertvector(__builtin_shufflevector(xy01, xy23, 0, 1, 4, 5), Doubles);
  const auto y = __builtin_convertvector(__builtin_shufflevector(xy01, xy23, 2, 3, 6, 7), Doubles);
  const auto z = __builtin_convertvector(__builtin_shufflevector(z01, z23, 0, 1, 4, 5), Doubles);
  // Additions in the order of the authors' program: the same roundings.
  const Doubles px = ((r[0] * x + r[1] * y) + r[2] * z) + t[0];
  const Doubles py = ((r[3] * x + r[4] * y) + r[5] * z) + t[1];
  const Doubles pz = ((r[6] * x + r[7] * y) + r[8] * z) + t[2];
  const Doubles dx = px - o[0], dy = py - o[1], dz = pz - o[2];
  const Doubles range_sq_m2 = (dx * dx + dy * dy) + dz * dz;
  const Doubles vx = floor_of(px / projection.voxel_size_m) - projection.origin[0];
  const Doubles vy = floor_of(py / projection.voxel_size_m) - projection.origin[1];
  const Doubles vz = floor_of(pz / projection.voxel_size_m) - projection.origin[2];
  const Doubles reach = greatest(magnitude(vx - s[0]), magnitude(vy - s[1]), magnitude(vz - s[2]));
  const Doubles limit = greatest(magnitude(vx), magnitude(vy), magnitude(vz));
  const Choice fits = (reach < kReachFromSensor) & (limit < kReachFromOrigin);
  const Choice finite = ((x - x) + (y - y)) + (z - z) == 0.0;
  const Choice takes_part = range_sq_m2 > projection.min_range_sq_m2;
  const Doubles column = fits ? vx : Doubles{} + static_cast<double>(kOverflow);
  const Doubles near_or_column = takes_part ? column : Doubles{} + static_cast<double>(kTooNear);
  const Doubles why_or_column =
      finite ? near_or_column : Doubles{} + static_cast<double>(kNonfinite);
  store(__builtin_convertvector(why_or_column, Ints), &chunk.x[first]);
  store(__builtin_convertvector(fits ? vy : Doubles{}, Ints), &chunk.y[first]);
  store(__builtin_convertvector(fits ? vz : Doubles{}, Ints), &chunk.z[first]);
}

/// Finds the voxels of at most kChunk points.
MOSBENCH_MULTIARCH void project(std::span<const Point> points, const Projection& projection,
                                ProjectedChunk& chunk) {
  const std::size_t whole = points.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) project_four(&points[i], projection, i, chunk);
  if (whole == points.size()) return;
  std::array<Point, 4> rest{};
  std::copy(points.begin() + static_cast<std::ptrdiff_t>(whole), points.end(), rest.begin());
  project_four(rest.data(), projection, whole, chunk);
}

[[noreturn]] void throw_overflow(std::size_t point) {
  throw std::range_error(
      "point " + std::to_string(point) + ": its voxel index overflows, expected a point within " +
      std::to_string(static_cast<long>(kReachFromSensor)) + " voxels of the sensor");
}

/// A share of the scan's points with a voxel set of its own.
struct Part {
  std::size_t begin = 0, end = 0;
  VoxelSet voxels;
  std::size_t nonfinite_points = 0;
};

/// Returns how many points from `begin` on have its origin.
std::size_t of_one_origin(const RayOrigins& origins, std::size_t begin, std::size_t most) {
  if (origins.empty()) return most;
  const auto first = origins.of_point.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto is_other = [&](std::uint8_t origin) { return origin != *first; };
  return static_cast<std::size_t>(
      std::find_if(first, first + static_cast<std::ptrdiff_t>(most), is_other) - first);
}

/// `projections` has one for each origin.
void fill(Part& part, std::span<const Point> points, std::span<const Projection> projections,
          const RayOrigins& origins, std::span<std::uint32_t> voxel_of_point) {
  ProjectedChunk chunk;
  BlockIndex last_block{std::numeric_limits<std::int32_t>::max(), 0, 0};
  std::uint32_t slot = kNoSlot;
  for (std::size_t begin = part.begin, count = 0; begin < part.end; begin += count) {
    count = of_one_origin(origins, begin, std::min(kChunk, part.end - begin));
    const std::size_t origin = origins.empty() ? 0 : origins.of_point[begin];
    project(points.subspan(begin, count), projections[origin], chunk);
    for (std::size_t i = 0; i < count; ++i) {
      if (chunk.x[i] <= kOverflow) {
        if (chunk.x[i] == kOverflow) throw_overflow(begin + i);
        part.nonfinite_points += chunk.x[i] == kNonfinite;
        voxel_of_point[begin + i] = kNoVoxel;
        continue;
      }
      const Voxel voxel{chunk.x[i], chunk.y[i], chunk.z[i]};
      const BlockIndex block = block_of(voxel);
      if (!(block == last_block)) {
        slot = part.voxels.insert(block);
        last_block = block;
      }
      const std::uint32_t cell = cell_of(voxel);
      part.voxels.masks[slot].set(cell);
      voxel_of_point[begin + i] = slot * kBlockVoxels + cell;
    }
  }
}

/// Unites the parts' voxels in the first part and renumbers the points of the others.
void merge(std::vector<Part>& parts, std::span<std::uint32_t> voxel_of_point) {
  VoxelSet& all = parts.front().voxels;
  std::vector<std::uint32_t> slot_in_all;
  for (std::size_t p = 1; p < parts.size(); ++p) {
    const VoxelSet& own = parts[p].voxels;
    slot_in_all.clear();
    for (std::size_t slot = 0; slot < own.block_count(); ++slot) {
      slot_in_all.push_back(all.insert(own.blocks[slot]));
      BlockMask& mask = all.masks[slot_in_all.back()];
      mask = mask | own.masks[slot];
    }
    for (std::size_t i = parts[p].begin; i < parts[p].end; ++i) {
      std::uint32_t& voxel = voxel_of_point[i];
      if (voxel == kNoVoxel) continue;
      voxel = slot_in_all[voxel / kBlockVoxels] * kBlockVoxels + voxel % kBlockVoxels;
    }
  }
}

Projection projection_of(const Pose& map_from_sensor, const VoxelGrid& grid, double min_range_m) {
  Projection projection{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      projection.rotation[row * 3 + column] = map_from_sensor(row, column);
    }
    projection.translation[row] = map_from_sensor.translation()[row];
    projection.origin[row] = grid.origin_voxels[row];
  }
  projection.voxel_size_m = grid.voxel_size_m;
  projection.min_range_sq_m2 = min_range_m * std::abs(min_range_m);
  return projection;
}

/// The same for points whose rays start elsewhere.
Projection seen_from(const Eigen::Vector3d& sensor_m, const Voxel& sensor_voxel,
                     Projection projection) {
  for (int axis = 0; axis < 3; ++axis) projection.sensor_m[axis] = sensor_m[axis];
  projection.sensor_voxel[0] = sensor_voxel.x;
  projection.sensor_voxel[1] = sensor_voxel.y;
  projection.sensor_voxel[2] = sensor_voxel.z;
  return projection;
}

/// Adds what each sensor measured to a scan whose points have voxels.
void add_measured_by_origin(const RayOrigins& origins, VoxelizedScan& scan) {
  for (OwnVoxels& own : scan.by_origin) {
    own.measured = scan.measured;
    std::ranges::fill(own.measured.masks, BlockMask{});
  }
  for (std::size_t i = 0; i < origins.of_point.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    VoxelSet& measured = scan.by_origin[origins.of_point[i]].measured;
    measured.masks[voxel / kBlockVoxels].set(voxel % kBlockVoxels);
  }
}

}  // namespace

VoxelSet VoxelizedScan::occupied_among(const VoxelSet& voxels) const {
  VoxelSet both;
  for (std::size_t i = 0; i < voxels.block_count(); ++i) {
    const BlockMask* occupied_here = occupied_in(voxels.blocks[i]);
    if (occupied_here == nullptr) continue;
    const BlockMask mask = *occupied_here & voxels.masks[i];
    if (mask.any()) both.masks[both.insert(voxels.blocks[i])] = mask;
  }
  return both;
}

VoxelGrid grid_around(const Eigen::Vector3d& sensor_m, double voxel_size_m) {
  VoxelGrid grid{.voxel_size_m = voxel_size_m};
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin_voxels[axis] = std::floor(sensor_m[axis] / voxel_size_m / kBlockSide) * kBlockSide;
  }
  return grid;
}

Voxel voxel_of(const Eigen::Vector3d& position_m, const VoxelGrid& grid) {
  Voxel voxel;
  const std::array<std::int32_t*, 3> coordinates{&voxel.x, &voxel.y, &voxel.z};
  for (int axis = 0; axis < 3; ++axis) {
    const double index =
        std::floor(position_m[axis] / grid.voxel_size_m) - grid.origin_voxels[axis];
    if (!(std::abs(index) < kReachFromOrigin)) {
      throw std::range_error(
          "sensor position: its voxel index overflows, expected a position within " +
          std::to_string(static_cast<long>(kReachFromOrigin)) + " voxels of the first scan");
    }
    *coordinates[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(index);
  }
  return voxel;
}

VoxelizedScan voxelize(std::span<const Point> points, const Pose& map_from_sensor,
                       const VoxelGrid& grid, double min_range_m, double max_range_m,
                       ThreadPool& pool, const RayOrigins& origins) {
  VoxelizedScan scan;
  scan.sensor_m = map_from_sensor.translation();
  scan.sensor_voxel = voxel_of(scan.sensor_m, grid);
  for (const Eigen::Vector3d& position : origins.positions_m) {
    const Eigen::Vector3d sensor_m = map_from_sensor * position;
    scan.by_origin.push_back({sensor_m, voxel_of(sensor_m, grid), {}});
  }
  std::vector<Projection> projections;
  scan.for_each_origin([&](const auto& sensor_m, const Voxel& sensor_voxel, const VoxelSet&) {
    projections.push_back(
        seen_from(sensor_m, sensor_voxel, projection_of(map_from_sensor, grid, min_range_m)));
  });

  scan.voxel_of_point.resize(points.size());
  std::vector<Part> parts(pool.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    parts[p].begin = points.size() * p / parts.size();
    parts[p].end = points.size() * (p + 1) / parts.size();
  }
  pool.for_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t p = begin; p < end; ++p) {
      fill(parts[p], points, projections, origins, scan.voxel_of_point);
    }
  });
  merge(parts, scan.voxel_of_point);
  for (const Part& part : parts) scan.nonfinite_points += part.nonfinite_points;
  scan.measured = std::move(parts.front().voxels);

  add_measured_by_origin(origins, scan);
  for (std::size_t slot = 0; slot < scan.measured.block_count(); ++slot) {
    BlockMask& occupied = scan.occupied.emplace_back();
    scan.for_each_origin([&](const auto& sensor_m, const Voxel&, const VoxelSet& measured) {
      occupied = occupied | within_range(grid, measured.blocks[slot], measured.masks[slot],
                                         sensor_m, max_range_m);
    });
    scan.occupied_count += occupied.count();
  }
  return scan;
}

std::vector<std::uint32_t> project_labels(const VoxelizedScan& scan,
                                          std::span<const BlockMask> moving) {
  std::vector<std::uint32_t> labels(scan.voxel_of_point.size(), kStaticLabel);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const std::uint32_t voxel = scan.voxel_of_point[i];
    if (voxel == kNoVoxel) continue;
    if (moving[voxel / kBlockVoxels].test(voxel % kBlockVoxels)) labels[i] = kMovingLabel;
  }
  return labels;
}

}  // namespace mosbench
