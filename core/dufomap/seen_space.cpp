#include "core/dufomap/seen_space.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/voxel/exact_rays.hpp"
#include "core/voxel/grid_walk.hpp"
#include "core/voxel/neighbourhood.hpp"

namespace mosbench::dufomap {
namespace {

/// A ray to the centre of a voxel; metres from the grid's origin.
struct Sight {
  Eigen::Vector3d direction;
  double length_m;
};

Eigen::Vector3d centre_m(const Voxel& v, double voxel_size_m) {
  return Eigen::Vector3d(v.x + 0.5, v.y + 0.5, v.z + 0.5) * voxel_size_m;
}

Voxel voxel_at_position(const Eigen::Vector3d& p_m, double voxel_size_m) {
  const auto index = [&](double p) {
    return static_cast<std::int32_t>(std::floor(p / voxel_size_m));
  };
  return {index(p_m.x()), index(p_m.y()), index(p_m.z())};
}

Voxel difference(const Voxel& a, const Voxel& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// Sights of one scan and the window that holds all that they touch.
class Caster {
 public:
  Caster(const VoxelizedScan& scan, const VoxelGrid& grid, const Config& config)
      : scan_(scan),
        config_(config),
        sensor_m_(scan.sensor_m - grid.origin_voxels * grid.voxel_size_m) {
    // Not scan.sensor_voxel, which is rounded otherwise and may be the one beside.
    sensor_ = voxel_at_position(sensor_m_, config.resolution_m);
    box_ = {sensor_, sensor_};
    for (const BlockIndex& block : scan.measured.blocks) include(block);
    // The last d_s may begin behind the sensor.
    const double behind = std::ceil(config.sensor_noise_m / config.resolution_m);
    box_.widen(static_cast<std::int32_t>(behind) + 2 * (config.pose_error_voxels + 1));
  }

  BlockIndex lay_out(RayWindow& window) {
    const BlockIndex first = lay_out_around(box_, window);
    corner_ = voxel_at(first, 0);
    return first;
  }

  /// Calls visit(goal, sight) for the measured voxels of a block.
  template <typename Visit>
  void for_each_sight(std::size_t slot, Visit&& visit) const {
    for_each_cell(scan_.measured.masks[slot], [&](std::uint32_t cell) {
      const Voxel goal = voxel_at(scan_.measured.blocks[slot], cell);
      const Eigen::Vector3d line_m = centre_m(goal, config_.resolution_m) - sensor_m_;
      const double length_m = line_m.norm();
      if (length_m > 0) visit(goal, Sight{line_m / length_m, length_m});
    });
  }

  void mark_hits(std::size_t slot, const WindowBits& bits, WindowPen& pen) const {
    for_each_sight(slot, [&](const Voxel& goal, const Sight& sight) {
      if (sight.length_m > config_.max_range_m) return;
      const Eigen::Vector3d from_m =
          centre_m(goal, config_.resolution_m) - sight.direction * config_.sensor_noise_m;
      WindowWalk walk = start(from_m, sight, bits);
      pen.mark(walk.at());
      while (walk.nearest_m() < config_.sensor_noise_m) {
        walk.advance();
        pen.mark(walk.at());
      }
      // Rounding may have kept the walk from its end.
      pen.mark(bits.at(difference(goal, corner_)));
    });
  }

  /// Appends the rays to the voxels of a block.
  void append_rays(std::size_t slot, const WindowBits& bits, std::vector<ExactRay>& rays) const {
    const std::uint64_t sensor_bit = bits.at(difference(sensor_, corner_));
    for_each_sight(slot, [&](const Voxel&, const Sight& sight) {
      const double length_m = std::min(sight.length_m, config_.max_range_m);
      const double steps = length_m * sight.direction.lpNorm<1>() / config_.resolution_m;
      rays.push_back({BorderCrossings(sensor_m_, sight.direction, sensor_, config_.resolution_m),
                      length_m, sensor_bit, 0, static_cast<std::uint32_t>(steps)});
    });
  }

 private:
  void include(const BlockIndex& block) {
    const auto reach =
        static_cast<std::int32_t>(std::ceil(config_.max_range_m / config_.resolution_m)) + 1;
    const auto near = [&](std::int32_t index, std::int32_t sensor) {
      return std::clamp(index, sensor - reach, sensor + reach);
    };
    for (const std::uint32_t cell : {0U, static_cast<std::uint32_t>(kBlockVoxels - 1)}) {
      const Voxel v = voxel_at(block, cell);
      box_.include({near(v.x, sensor_.x), near(v.y, sensor_.y), near(v.z, sensor_.z)});
    }
  }

  WindowWalk start(const Eigen::Vector3d& from_m, const Sight& sight,
                   const WindowBits& bits) const {
    const Voxel voxel = voxel_at_position(from_m, config_.resolution_m);
    return {bits, bits.at(difference(voxel, corner_)),
            BorderCrossings(from_m, sight.direction, voxel, config_.resolution_m)};
  }

  const VoxelizedScan& scan_;
  const Config& config_;
  Eigen::Vector3d sensor_m_;  ///< from the grid's origin
  Voxel sensor_, corner_;
  VoxelBox box_;
};

VoxelSet set_of(VoxelList list) {
  VoxelSet set;
  set.reserve(list.blocks.size());
  for (std::size_t i = 0; i < list.blocks.size(); ++i) {
    set.masks[set.insert(list.blocks[i])] = list.masks[i];
  }
  return set;
}

}  // namespace

std::size_t SightScratch::memory_bytes() const {
  std::size_t bytes = hits.memory_bytes();
  for (const RayWindow& window : crossed) bytes += window.memory_bytes();
  return bytes;
}

SeenSpace see(const VoxelizedScan& scan, const VoxelGrid& grid, const Config& config,
              SightScratch& scratch, ThreadPool& pool) {
  const std::size_t blocks = scan.measured.block_count();
  if (blocks == 0) return {};
  Caster caster(scan, grid, config);
  const BlockIndex first = caster.lay_out(scratch.hits);
  scratch.crossed.resize(pool.size());
  for (RayWindow& window : scratch.crossed) caster.lay_out(window);
  const WindowBits bits(scratch.hits);
  WindowPen hit_pen(scratch.hits);
  for (std::size_t slot = 0; slot < blocks; ++slot) caster.mark_hits(slot, bits, hit_pen);
  // Every share has blocks from all directions, so that all take about as long.
  const std::size_t shares = 4 * pool.size();
  pool.for_ranges(shares, 1, [&](std::size_t share, std::size_t, unsigned thread) {
    std::vector<ExactRay> rays;
    for (std::size_t slot = share; slot < blocks; slot += shares) {
      caster.append_rays(slot, bits, rays);
    }
    cast_exact(rays, RayEnd::kAtHit, scratch.hits, config.pose_error_voxels,
               scratch.crossed[thread]);
  });
  return {set_of(collect(scratch.crossed, first, pool)),
          set_of(collect({&scratch.hits, 1}, first, pool))};
}

VoxelList void_of(const SeenSpace& seen, int pose_error_voxels, ThreadPool& pool) {
  const VoxelSet known = united(seen.crossed, seen.hit);
  VoxelList voids{seen.crossed.blocks, {}};
  voids.masks.resize(voids.blocks.size());
  pool.for_ranges(voids.blocks.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows unknown;
    for (std::size_t i = begin; i < end; ++i) {
      BlockMask candidates = seen.crossed.masks[i];
      if (const BlockMask* hit = seen.hit.mask_of(voids.blocks[i])) {
        candidates = without(candidates, *hit);
      }
      gather_around(known, voids.blocks[i], pose_error_voxels, unknown);
      invert(unknown);
      voids.masks[i] = without(candidates, dilate(unknown));
    }
  });
  return voids;
}

}  // namespace mosbench::dufomap
