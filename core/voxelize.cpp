#include "core/voxelize.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/multiarch.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kChunk = 512;
constexpr double kReachFromOrigin = 1 << 23;
constexpr double kReachFromSensor = 1 << 19;

// Points without a voxel carry the reason in x.
constexpr std::int32_t kTooNear = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kNonfinite = kTooNear + 1;
constexpr std::int32_t kOverflow = kTooNear + 2;

struct Projection {
  double rotation[9], translation[3], origin[3], sensor_voxel[3];
  double voxel_size_m, min_range_sq_m2;
};

struct ProjectedChunk {
  std::array<std::int32_t, kChunk> x, y, z;
};

MOSBENCH_MULTIARCH void project(std::span<const Point> points, const Projection& projection,
                                ProjectedChunk& chunk) {
  const double* r = projection.rotation;
  const double* t = projection.translation;
  const double* s = projection.sensor_voxel;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double x = points[i].x, y = points[i].y, z = points[i].z;
    // Order of additions as in the authors' program.
    const double px = ((r[0] * x + r[1] * y) + r[2] * z) + t[0];
    const double py = ((r[3] * x + r[4] * y) + r[5] * z) + t[1];
    const double pz = ((r[6] * x + r[7] * y) + r[8] * z) + t[2];
    const double dx = px - t[0], dy = py - t[1], dz = pz - t[2];
    const double range_sq_m2 = (dx * dx + dy * dy) + dz * dz;
    const double vx = std::floor(px / projection.voxel_size_m) - projection.origin[0];
    const double vy = std::floor(py / projection.voxel_size_m) - projection.origin[1];
    const double vz = std::floor(pz / projection.voxel_size_m) - projection.origin[2];
    const double reach =
        std::max(std::max(std::abs(vx - s[0]), std::abs(vy - s[1])), std::abs(vz - s[2]));
    const double limit = std::max(std::max(std::abs(vx), std::abs(vy)), std::abs(vz));
    const bool fits = (reach < kReachFromSensor) & (limit < kReachFromOrigin);
    const bool finite = ((x - x) + (y - y)) + (z - z) == 0.0;
    const bool takes_part = range_sq_m2 > projection.min_range_sq_m2;
    const double column = fits ? vx : static_cast<double>(kOverflow);
    const double near_or_column = takes_part ? column : static_cast<double>(kTooNear);
    chunk.x[i] =
        static_cast<std::int32_t>(finite ? near_or_column : static_cast<double>(kNonfinite));
    chunk.y[i] = static_cast<std::int32_t>(fits ? vy : 0.0);
    chunk.z[i] = static_cast<std::int32_t>(fits ? vz : 0.0);
  }
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

void fill(Part& part, std::span<const Point> points, const Projection& projection,
          std::span<std::uint32_t> voxel_of_point) {
  ProjectedChunk chunk;
  BlockIndex last_block{std::numeric_limits<std::int32_t>::max(), 0, 0};
  std::uint32_t slot = kNoSlot;
  for (std::size_t begin = part.begin; begin < part.end; begin += kChunk) {
    const std::size_t count = std::min(kChunk, part.end - begin);
    project(points.subspan(begin, count), projection, chunk);
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

}  // namespace

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
                       ThreadPool& pool) {
  VoxelizedScan scan;
  scan.sensor_m = map_from_sensor.translation();
  scan.sensor_voxel = voxel_of(scan.sensor_m, grid);
  Projection projection{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      projection.rotation[row * 3 + column] = map_from_sensor(row, column);
    }
    projection.translation[row] = scan.sensor_m[row];
    projection.origin[row] = grid.origin_voxels[row];
  }
  projection.sensor_voxel[0] = scan.sensor_voxel.x;
  projection.sensor_voxel[1] = scan.sensor_voxel.y;
  projection.sensor_voxel[2] = scan.sensor_voxel.z;
  projection.voxel_size_m = grid.voxel_size_m;
  projection.min_range_sq_m2 = min_range_m * min_range_m;

  scan.voxel_of_point.resize(points.size());
  std::vector<Part> parts(pool.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    parts[p].begin = points.size() * p / parts.size();
    parts[p].end = points.size() * (p + 1) / parts.size();
  }
  pool.for_ranges(parts.size(), 1, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t p = begin; p < end; ++p) {
      fill(parts[p], points, projection, scan.voxel_of_point);
    }
  });
  merge(parts, scan.voxel_of_point);
  for (const Part& part : parts) scan.nonfinite_points += part.nonfinite_points;
  scan.measured = std::move(parts.front().voxels);

  for (std::size_t slot = 0; slot < scan.measured.block_count(); ++slot) {
    scan.occupied.push_back(within_range(grid, scan.measured.blocks[slot],
                                         scan.measured.masks[slot], scan.sensor_m, max_range_m));
    scan.occupied_count += scan.occupied.back().count();
  }
  return scan;
}

}  // namespace mosbench
