#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "core/methods/hmm_mos/pipeline.hpp"

/// Seeded sequences of a few hundred points per scan: a room with boxes that move through it, cast
/// ray by ray. Small enough for methods that compare all pairs.
namespace mosbench {
using namespace hmm_mos;

struct SmallWorld {
  std::vector<std::vector<Point>> scans;
  std::vector<Pose> poses;
  std::vector<RayOrigins> origins;  ///< of a rig: one per scan

  /// Where the rays of scan k start.
  RayOrigins origins_of(std::size_t k) const { return origins.empty() ? RayOrigins{} : origins[k]; }
};

struct SmallWorldOptions {
  unsigned seed = 1;
  std::size_t scans = 16;
  int azimuths = 30, elevations = 12;  ///< rays per scan
  int moving_boxes = 2;
  double noise_m = 0.0;
  double jitter_rad = 0.03;                                ///< of each ray's direction
  double walk_m = 0.1;                                     ///< sensor step per scan
  Eigen::Vector3d origin_m{0.0, 0.0, 0.0};                 ///< of the room in the map frame
  std::vector<Eigen::Vector3d> jumps_m{{0.0, 0.0, 0.0}};   ///< the room's copy seen by scan k:
                                                           ///< entry k modulo the list's size
  std::vector<Eigen::Vector3d> mounts_m{{0.0, 0.0, 0.0}};  ///< of the sensors; several: a rig
  bool defects = false;  ///< empty scans, all too near or too far, NaN, infinite, duplicate points
};

/// A config for such a world.
inline Config small_world_config() {
  Config config;
  config.voxel_size_m = 0.4;
  config.min_range_m = 0.3;
  config.max_range_m = 5.0;
  config.kernel_width_voxels = 3;
  return config;
}

struct Box {
  Eigen::Vector3d low, high;
};

/// Distance to the box along a unit direction: where the ray enters it, or leaves it when inside.
inline double distance_to(const Box& box, const Eigen::Vector3d& from,
                          const Eigen::Vector3d& direction, bool inside) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.low[axis] - from[axis]) / direction[axis];
    const double b = (box.high[axis] - from[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (inside) return leave;
  return enter > 0 && enter < leave ? enter : std::numeric_limits<double>::infinity();
}

/// Makes some scans of a world what only a hostile data set holds.
inline void add_defects(SmallWorld& world, std::mt19937& random) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (std::vector<Point>& scan : world.scans) {
    switch (random() % 12) {
      case 0:
        scan.clear();
        break;
      case 1:
        for (Point& p : scan) p = {p.x * 0.01F, p.y * 0.01F, p.z * 0.01F, 0.0F};
        break;
      case 2:
        for (Point& p : scan) p = {p.x * 30.0F, p.y * 30.0F, p.z * 30.0F, 0.0F};
        break;
      case 3:
      case 4:
        scan.insert(scan.begin() + static_cast<std::ptrdiff_t>(scan.size() / 2),
                    {{nan, 1.0F, 1.0F, 0.0F},
                     {1.0F, infinity, 1.0F, 0.0F},
                     {1.0F, 1.0F, -infinity, 0.0F},
                     {0.0F, 0.0F, 0.0F, 0.0F},
                     {1e5F, -1e4F, 20.0F, 0.0F}});
        break;
      case 5:
        scan.insert(scan.end(), scan.begin(),
                    scan.begin() + static_cast<std::ptrdiff_t>(scan.size() / 3));
        break;
      default:
        break;
    }
  }
}

inline SmallWorld small_world(const SmallWorldOptions& options) {
  std::mt19937 random(options.seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  const Box room{{-3.6, -3.1, -1.3}, {3.4, 3.3, 1.45}};
  struct Mover {
    Eigen::Vector3d centre, half, step;
  };
  std::vector<Mover> movers;
  for (int i = 0; i < options.moving_boxes; ++i) {
    movers.push_back({{uniform(-2.5, 2.5), uniform(-2.5, 2.5), uniform(-0.5, 0.2)},
                      {uniform(0.3, 0.6), uniform(0.3, 0.6), uniform(0.5, 0.9)},
                      {uniform(-0.7, 0.7), uniform(-0.7, 0.7), uniform(-0.05, 0.05)}});
  }
  SmallWorld world;
  Eigen::Vector3d sensor{uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.2, 0.2)};
  const Eigen::Vector3d walk =
      Eigen::Vector3d{uniform(-1, 1), uniform(-1, 1), uniform(-0.2, 0.2)}.normalized() *
      options.walk_m;
  double yaw = uniform(0, 6);
  for (std::size_t k = 0; k < options.scans; ++k) {
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.translation() = options.origin_m + options.jumps_m[k % options.jumps_m.size()] + sensor;
    std::vector<Point>& points = world.scans.emplace_back();
    RayOrigins origins{options.mounts_m, {}};
    for (const Eigen::Vector3d& mount : options.mounts_m) {
      const Eigen::Vector3d from = sensor + pose.linear() * mount;
      for (int elevation = 0; elevation < options.elevations; ++elevation) {
        for (int azimuth = 0; azimuth < options.azimuths; ++azimuth) {
          const double a = 6.283185307179586 * (azimuth + 0.37) / options.azimuths +
                           uniform(-1, 1) * options.jitter_rad;
          const double e = -0.7 + 1.4 * (elevation + 0.41) / options.elevations +
                           uniform(-1, 1) * options.jitter_rad;
          const Eigen::Vector3d ray{std::cos(a) * std::cos(e), std::sin(a) * std::cos(e),
                                    std::sin(e)};
          double range = distance_to(room, from, ray, true);
          for (const Mover& mover : movers) {
            range =
                std::min(range, distance_to({mover.centre - mover.half, mover.centre + mover.half},
                                            from, ray, false));
          }
          range += options.noise_m * uniform(-1, 1);
          const Eigen::Vector3d p = pose.linear().transpose() * (ray * range) + mount;
          points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()),
                            static_cast<float>(p.z()), 0.0F});
          origins.of_point.push_back(static_cast<std::uint8_t>(&mount - options.mounts_m.data()));
        }
      }
    }
    if (options.mounts_m.size() > 1) world.origins.push_back(std::move(origins));
    world.poses.push_back(pose);
    if (std::abs(sensor.x() + walk.x()) < 1.5 && std::abs(sensor.y() + walk.y()) < 1.5) {
      sensor += walk;
    }
    if (options.walk_m > 0) yaw += 0.05;
    for (Mover& mover : movers) {
      mover.centre += mover.step;
      for (int axis = 0; axis < 3; ++axis) {
        if (mover.centre[axis] < room.low[axis] + 0.5 || mover.centre[axis] > room.high[axis] - 0.5)
          mover.step[axis] = -mover.step[axis];
      }
    }
  }
  if (options.defects) add_defects(world, random);
  return world;
}

inline Config of_variant(Config config, Variant variant) {
  config.variant = variant;
  return config;
}

/// All results of a method in scan order.
inline std::vector<LabelledScan> results_of(Method& pipeline, const SmallWorld& world) {
  std::vector<LabelledScan> all;
  const auto take = [&](std::vector<LabelledScan> results) {
    for (LabelledScan& result : results) all.push_back(std::move(result));
  };
  for (std::size_t k = 0; k < world.scans.size(); ++k) {
    take(pipeline.push(world.scans[k], world.poses[k], world.origins_of(k)));
  }
  take(pipeline.finish());
  return all;
}

/// The labels of a whole sequence, one vector per scan in scan order.
inline std::vector<std::vector<std::uint32_t>> labels_of(
    const SmallWorld& world, const Config& config, Variant variant, unsigned threads = 1,
    std::optional<std::size_t> scan_count = std::nullopt) {
  Pipeline pipeline(of_variant(config, variant), {threads, scan_count});
  std::vector<std::vector<std::uint32_t>> labels;
  for (LabelledScan& result : results_of(pipeline, world))
    labels.push_back(std::move(result.labels));
  return labels;
}

inline std::size_t moving_points(const std::vector<std::vector<std::uint32_t>>& labels) {
  std::size_t moving = 0;
  for (const auto& scan : labels) {
    moving += static_cast<std::size_t>(std::count(scan.begin(), scan.end(), kMovingLabel));
  }
  return moving;
}

/// Two sensors 2 m apart in the frame of the scans.
inline std::vector<Eigen::Vector3d> two_mounts() { return {{-1.0, 0.0, 0.0}, {1.0, 0.1, 0.2}}; }

/// Scans of a sensor that stands and looks ahead. Rays of slope y and z end at x = distance_m(k, y,
/// z) in scan k.
template <typename Distance>
SmallWorld world_ahead(std::size_t scans, Distance&& distance_m) {
  SmallWorld world;
  for (std::size_t k = 0; k < scans; ++k) {
    std::vector<Point>& scan = world.scans.emplace_back();
    world.poses.push_back(Pose::Identity());
    for (float y = -0.6F; y < 0.6F; y += 0.02F) {
      for (float z = -0.6F; z < 0.6F; z += 0.02F) {
        const float x = distance_m(k, y, z);
        scan.push_back({x, x * y, x * z, 0.0F});
      }
    }
  }
  return world;
}

/// A wall, and a box that was there before the first scan, leaves in the tenth and hides what it
/// drives into.
inline SmallWorld world_with_a_box_that_leaves() {
  return world_ahead(16, [](std::size_t k, float y, float z) {
    const float box_m = 1.4F + 0.5F * std::max(0.0F, static_cast<float>(k) - 9.0F);
    return std::abs(box_m * y) < 0.5F && std::abs(box_m * z) < 0.5F ? box_m : 4.9F;
  });
}

}  // namespace mosbench
