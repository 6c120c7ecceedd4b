#include "core/methods/dufomap/seen_space.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/voxel/grid_walk.hpp"
#include "core/voxel/neighbourhood.hpp"
#include "core/voxel/ray_runs.hpp"

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

/// Rays that go farthest along x, y and z.
using RaysByAxis = std::array<std::vector<ExactRay>, 3>;
using SensorBits = std::array<std::uint64_t, 3>;

constexpr std::array kBytes{RayWindow::BytesAlong::kX, RayWindow::BytesAlong::kY};

Voxel difference(const Voxel& a, const Voxel& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

/// Sights of one sensor of a scan, and a box that holds all that they touch.
class Caster {
 public:
  Caster(const VoxelSet& measured, const Eigen::Vector3d& sensor_m, const VoxelGrid& grid,
         const Config& config)
      : measured_(measured),
        config_(config),
        sensor_m_(sensor_m - grid.origin_voxels * grid.voxel_size_m) {
    // Not the scan's sensor_voxel, which is rounded otherwise and may be the one beside.
    sensor_ = voxel_at_position(sensor_m_, config.resolution_m);
    box_ = {sensor_, sensor_};
    for (const BlockIndex& block : measured.blocks) include(block);
    // The last d_s may begin behind the sensor.
    const double behind = std::ceil(config.sensor_noise_m / config.resolution_m);
    box_.widen(static_cast<std::int32_t>(behind) + 2 * (config.pose_error_voxels + 1));
  }

  const VoxelBox& box() const { return box_; }
  /// Takes the first block of the windows.
  void use_windows_from(const BlockIndex& first) { corner_ = voxel_at(first, 0); }

  /// Calls visit(goal, sight) for the measured voxels of a block.
  template <typename Visit>
  void for_each_sight(std::size_t slot, Visit&& visit) const {
    for_each_cell(measured_.masks[slot], [&](std::uint32_t cell) {
      const Voxel goal = voxel_at(measured_.blocks[slot], cell);
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

  /// Appends the rays to the voxels of a block, each to those that go farthest along its axis.
  void append_rays(std::size_t slot, const SensorBits& sensor_bits, RaysByAxis& rays) const {
    for_each_sight(slot, [&](const Voxel&, const Sight& sight) {
      const double length_m = std::min(sight.length_m, config_.max_range_m);
      Eigen::Index axis = 0;
      const Eigen::Array3d extent = sight.direction.array().abs();
      const double longest = extent.maxCoeff(&axis);
      double borders = extent.sum();
      // Of the voxels along the bytes only one in eight is a step.
      if (axis < 2) borders -= longest * (kBlockSide - 1) / kBlockSide;
      const auto along = static_cast<std::size_t>(axis);
      rays[along].push_back(
          {BorderCrossings(sensor_m_, sight.direction, sensor_, config_.resolution_m), length_m,
           sensor_bits[along], 0,
           static_cast<std::uint32_t>(length_m * borders / config_.resolution_m)});
    });
  }
  /// Returns the measured blocks in the order of their azimuths.
  std::vector<std::uint32_t> slots_by_azimuth() const {
    std::vector<std::pair<float, std::uint32_t>> azimuths;
    for (const BlockIndex& block : measured_.blocks) {
      const Voxel from_sensor = difference(voxel_at(block, 0), sensor_);
      azimuths.emplace_back(std::atan2(static_cast<float>(from_sensor.y + kBlockSide / 2),
                                       static_cast<float>(from_sensor.x + kBlockSide / 2)),
                            static_cast<std::uint32_t>(azimuths.size()));
    }
    std::ranges::sort(azimuths);
    std::vector<std::uint32_t> slots;
    for (const auto& [azimuth, slot] : azimuths) slots.push_back(slot);
    return slots;
  }
  /// Returns the sensor's bit in the windows of the rays along each axis.
  SensorBits sensor_bits(std::span<const RayWindow, 2> windows) const {
    const Voxel from_corner = difference(sensor_, corner_);
    const std::uint64_t along_x = WindowBits(windows[0]).at(from_corner);
    return {along_x, WindowBits(windows[1]).at(from_corner), along_x};
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

  const VoxelSet& measured_;
  const Config& config_;
  Eigen::Vector3d sensor_m_;  ///< from the grid's origin
  Voxel sensor_, corner_;
  VoxelBox box_;
};

/// Lays windows out in pairs: bytes along x, bytes along y. Returns their first block.
BlockIndex lay_out(const VoxelBox& box, std::span<RayWindow> windows) {
  BlockIndex first;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    first = lay_out_around(box, windows[i], kBytes[i % 2]);
  }
  return first;
}

/// Casts rays into windows with bytes along x and y.
void cast(RaysByAxis& rays, const SensorBits& sensor_bits, std::span<const RayWindow, 2> hits,
          int beyond_voxels, std::span<RayWindow, 2> crossed) {
  std::vector<ExactRay>& others = rays[2];
  for (std::size_t axis = 0; axis < 2; ++axis) {
    cast_runs(rays[axis], hits[axis], beyond_voxels, crossed[axis], others);
  }
  for (ExactRay& ray : others) ray.start = sensor_bits[2];
  cast_exact(others, RayEnd::kAtHit, hits[0], beyond_voxels, crossed[0]);
}

/// Casts the rays of one sensor.
void cast_all(const Caster& caster, std::size_t blocks, const Config& config, SightScratch& scratch,
              ThreadPool& pool) {
  const SensorBits sensor_bits = caster.sensor_bits(scratch.hits);
  const std::vector<std::uint32_t> slots = caster.slots_by_azimuth();
  // Every share has a narrow sector for each of the rays that are walked together. The next eight
  // rays lead through the same memory, and all shares take about as long.
  const std::size_t shares = 16 * pool.size(), sectors = shares * kRaysTogether;
  pool.for_ranges(shares, 1, [&](std::size_t share, std::size_t, unsigned thread) {
    RaysByAxis rays;
    for (std::size_t sector = share; sector < sectors; sector += shares) {
      const std::size_t end = blocks * (sector + 1) / sectors;
      for (std::size_t i = blocks * sector / sectors; i < end; ++i) {
        caster.append_rays(slots[i], sensor_bits, rays);
      }
    }
    cast(rays, sensor_bits, scratch.hits, config.pose_error_voxels,
         std::span(scratch.crossed).subspan(2 * std::size_t{thread}).first<2>());
  });
}

SeenSpace space_of(VoxelList crossed, const VoxelList& hit) {
  SeenSpace seen;
  seen.known.reserve(crossed.blocks.size() + hit.blocks.size());
  for (std::size_t i = 0; i < crossed.blocks.size(); ++i) {
    seen.known.masks[seen.known.insert(crossed.blocks[i])] = crossed.masks[i];
  }
  seen.passed = std::move(crossed.masks);
  for (std::size_t i = 0; i < hit.blocks.size(); ++i) {
    const std::uint32_t slot = seen.known.insert(hit.blocks[i]);
    seen.passed.resize(seen.known.block_count());
    seen.passed[slot] = without(seen.passed[slot], hit.masks[i]);
    seen.known.masks[slot] = seen.known.masks[slot] | hit.masks[i];
  }
  return seen;
}

/// Returns the passed voxels of a block with no unknown voxel within d_p in their block.
BlockMask surrounded_inside(const SeenSpace& seen, std::size_t slot, int pose_error_voxels) {
  BlockMask unknown = ~seen.known.masks[slot];
  for (int i = 0; i < pose_error_voxels; ++i) unknown = grown_inside(unknown);
  return without(seen.passed[slot], unknown);
}

}  // namespace

std::size_t SightScratch::memory_bytes() const {
  std::size_t bytes = 0;
  for (const RayWindow& window : hits) bytes += window.memory_bytes();
  for (const RayWindow& window : crossed) bytes += window.memory_bytes();
  return bytes;
}

SeenSpace see(const VoxelizedScan& scan, const VoxelGrid& grid, const Config& config,
              SightScratch& scratch, ThreadPool& pool) {
  const std::size_t blocks = scan.measured.block_count();
  if (blocks == 0) return {};
  std::vector<Caster> casters;
  scan.for_each_origin([&](const auto& sensor_m, const Voxel&, const VoxelSet& measured) {
    casters.emplace_back(measured, sensor_m, grid, config);
  });
  VoxelBox box = casters.front().box();
  for (const Caster& caster : casters) {
    box.include(caster.box().low);
    box.include(caster.box().high);
  }
  scratch.crossed.resize(2 * pool.size());
  lay_out(box, scratch.crossed);
  auto& [hits, turned_hits] = scratch.hits;
  const BlockIndex first = lay_out(box, scratch.hits);
  const WindowBits bits(hits);
  WindowPen hit_pen(hits);
  for (Caster& caster : casters) {
    caster.use_windows_from(first);
    for (std::size_t slot = 0; slot < blocks; ++slot) caster.mark_hits(slot, bits, hit_pen);
  }
  turned_hits.copy_turned(hits);
  for (const Caster& caster : casters) cast_all(caster, blocks, config, scratch, pool);
  return space_of(collect(scratch.crossed, first, pool), collect(scratch.hits, first, pool));
}

VoxelList new_voids(const SeenSpace& seen, const BlockMap<BlockMask>& ever_void,
                    int pose_error_voxels, ThreadPool& pool) {
  VoxelList voids{seen.known.blocks, {}};
  voids.masks.resize(voids.blocks.size());
  pool.for_ranges(voids.blocks.size(), 64, [&](std::size_t begin, std::size_t end, unsigned) {
    HaloRows unknown;
    for (std::size_t i = begin; i < end; ++i) {
      BlockMask candidates = surrounded_inside(seen, i, pose_error_voxels);
      if (!candidates.any()) continue;
      const std::uint32_t slot = ever_void.find(voids.blocks[i]);
      if (slot != kNoSlot) candidates = without(candidates, ever_void[slot]);
      // Few blocks are left, for which the blocks around are looked up.
      if (!candidates.any()) continue;
      gather_around(seen.known, voids.blocks[i], pose_error_voxels, unknown);
      invert(unknown);
      voids.masks[i] = without(candidates, dilate(unknown));
    }
  });
  return voids;
}

}  // namespace mosbench::dufomap
