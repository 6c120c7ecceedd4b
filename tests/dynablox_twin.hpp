#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/methods/dynablox/clusters.hpp"
#include "core/methods/dynablox/config.hpp"
#include "core/tsdf/range_image.hpp"
#include "core/tsdf/sensor_model.hpp"
#include "core/voxel/voxel.hpp"

/// Dynablox voxel by voxel, without masks, bounds or lists of what may change: maps of single
/// voxels and loops over all of them, in the words of the method. The projection into the image is
/// that of the method, so that numbers are equal.
namespace mosbench::dynablox_twin {
using namespace dynablox;
using namespace tsdf;
using dynablox::Config;

/// Index of a voxel, or of a wide block, in the map frame: z, y, x.
using Index = std::array<long, 3>;

inline Index wide_block(const Index& v) {
  const auto down = [](long a) { return a >= 0 ? a / 16 : -((15 - a) / 16); };
  return {down(v[0]), down(v[1]), down(v[2])};
}

struct TwinVoxel {
  float d = 0, w = 0;
  long last_occupied = 0, run = 0;
  bool ever_free = false;
};

struct TwinResult {
  std::vector<std::uint32_t> labels;
  std::vector<float> scores;
};

template <typename Visit>
void for_each_of_27(const Index& v, Visit&& visit) {
  for (long z = -1; z <= 1; ++z) {
    for (long y = -1; y <= 1; ++y) {
      for (long x = -1; x <= 1; ++x) visit(Index{v[0] + z, v[1] + y, v[2] + x});
    }
  }
}

/// Clusters as the authors' loops find them: groups of voxels in the order of their seeds.
struct TwinCluster {
  std::vector<Index> voxels;
  std::set<Index> all;  ///< also those of clusters that were merged into it
};

inline VoxelBox box_around(const std::vector<Index>& voxels) {
  VoxelBox box{{voxels[0][2], voxels[0][1], voxels[0][0]},
               {voxels[0][2], voxels[0][1], voxels[0][0]}};
  for (const Index& v : voxels) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min<std::int64_t>(box.low[axis], v[2 - axis]);
      box.high[axis] = std::max<std::int64_t>(box.high[axis], v[2 - axis]);
    }
  }
  return box;
}

/// `seeds` are in the order in which clusters begin.
inline std::vector<TwinCluster> twin_clusters(const std::set<Index>& occupied,
                                              const std::vector<Index>& seeds,
                                              const Config& config) {
  const std::set<Index> seed_set(seeds.begin(), seeds.end());
  std::set<Index> taken;
  std::vector<TwinCluster> clusters;
  for (const Index& seed : seeds) {
    if (taken.contains(seed)) continue;
    TwinCluster cluster;
    std::vector<Index> queue{seed};
    taken.insert(seed);
    cluster.voxels.push_back(seed);
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const Index at = queue[i];
      for (const Index& next : {Index{at[0] - 1, at[1], at[2]}, Index{at[0] + 1, at[1], at[2]},
                                Index{at[0], at[1] - 1, at[2]}, Index{at[0], at[1] + 1, at[2]},
                                Index{at[0], at[1], at[2] - 1}, Index{at[0], at[1], at[2] + 1}}) {
        if (!occupied.contains(next) || !taken.insert(next).second) continue;
        cluster.voxels.push_back(next);
        if (seed_set.contains(next)) queue.push_back(next);
      }
    }
    cluster.all.insert(cluster.voxels.begin(), cluster.voxels.end());
    clusters.push_back(cluster);
  }
  const auto near = [&](const TwinCluster& a, const TwinCluster& b) {
    for (const Index& p : a.voxels) {
      for (const Index& q : b.voxels) {
        const double distance = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
        if (distance <= config.cluster_separation_voxels * 1.0005) return true;
      }
    }
    return false;
  };
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    for (std::size_t j = i + 1; j < clusters.size();) {
      if (overlap(box_around(clusters[i].voxels), box_around(clusters[j].voxels),
                  config.cluster_separation_voxels, config.box_test) &&
          near(clusters[i], clusters[j])) {
        clusters[i].all.insert(clusters[j].all.begin(), clusters[j].all.end());
        clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(j));
      } else {
        ++j;
      }
    }
  }
  return clusters;
}

class DynabloxTwin {
 public:
  explicit DynabloxTwin(const Config& config)
      : config_(config), sensor_(*configured_sensor(config)) {}

  TwinResult push(const std::vector<Point>& points, const Pose& pose) {
    ++frame_;
    const std::vector<Index> voxels = index(points, pose);
    TwinResult result = judge(points, voxels);
    update_ever_free(std::set<Index>(voxels.begin(), voxels.end()));
    integrate(points, pose);
    return result;
  }

  std::size_t ever_free_voxels() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(map_, [](const auto& entry) { return entry.second.ever_free; }));
  }

 protected:
  static constexpr Index kNowhere{1L << 40, 0, 0};

  /// A. The voxel of every point; kNowhere for those that do not take part.
  std::vector<Index> index(const std::vector<Point>& points, const Pose& pose) const {
    std::vector<Index> voxels;
    for (const Point& p : points) {
      const Eigen::Vector3d at(p.x, p.y, p.z);
      const Eigen::Vector3d m = pose.linear() * at + pose.translation();
      const double range_m = (m - pose.translation()).norm();
      const bool takes_part = at.allFinite() && (config_.missing_returns == MissingReturns::kKeep ||
                                                 range_m > config_.min_range_m);
      const auto cell = [&](int axis) {
        return static_cast<long>(std::floor(m[axis] / config_.voxel_size_m));
      };
      voxels.push_back(takes_part ? Index{cell(2), cell(1), cell(0)} : kNowhere);
    }
    return voxels;
  }

  /// B. Clusters of points in ever-free voxels.
  TwinResult judge(const std::vector<Point>& points, const std::vector<Index>& voxels) {
    TwinResult result{std::vector<std::uint32_t>(points.size(), kStaticLabel), {}};
    std::set<Index> occupied, seed_set;
    for (const Index& v : voxels) {
      const auto found = map_.find(v);
      const bool ever_free = found != map_.end() && found->second.ever_free;
      const bool known = found != map_.end() && found->second.w > 0;
      result.scores.push_back((known ? found->second.d : 0) +
                              (ever_free ? config_.truncation_m() : 0));
      if (v != kNowhere) occupied.insert(v);
      if (ever_free) seed_set.insert(v);
    }
    std::vector<Index> seeds(seed_set.begin(), seed_set.end());
    std::ranges::stable_sort(seeds, {}, [](const Index& v) {
      return Index{v[0] >> 3, v[1] >> 3, v[2] >> 3};
    });
    std::set<Index> moving = seed_set;
    if (config_.level == Level::kObject) {
      moving.clear();
      for (const TwinCluster& cluster : twin_clusters(occupied, seeds, config_)) {
        const auto count =
            std::ranges::count_if(voxels, [&](const Index& v) { return cluster.all.contains(v); });
        if (count < config_.min_cluster_points) continue;
        moving.insert(cluster.all.begin(), cluster.all.end());
      }
    }
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (moving.contains(voxels[i])) result.labels[i] = kMovingLabel;
    }
    return result;
  }

  /// D. Voxel by voxel, one wide block after the other.
  void update_ever_free(const std::set<Index>& occupied) {
    std::vector<Index> later;
    for (const Index& wide : touched_) {
      for_each_voxel(wide, [&](const Index& v) {
        TwinVoxel& voxel = map_.at(v);
        if (voxel.d < config_.occupied_below_m() || occupied.contains(v)) {
          const bool goes_on = voxel.last_occupied >= frame_ - config_.temporal_buffer_scans;
          voxel.run = goes_on ? voxel.run + 1 : 1;
          voxel.last_occupied = frame_;
        }
        if (voxel.run < config_.counter_to_reset_scans || !voxel.ever_free) return;
        for_each_of_27(v, [&](const Index& near) {
          if (wide_block(near) == wide) {
            map_.at(near).ever_free = false;
          } else {
            later.push_back(near);
          }
        });
      });
    }
    for (const Index& v : later) {
      if (map_.contains(v)) map_.at(v).ever_free = false;
    }
    const auto is_free = [&](const Index& v) {
      const auto found = map_.find(v);
      return found != map_.end() && found->second.w > 1e-6F &&
             found->second.last_occupied <= frame_ - config_.burn_in_scans;
    };
    for (const Index& wide : touched_) {
      for_each_voxel(wide, [&](const Index& v) {
        if (!is_free(v)) return;
        bool all = true;
        for_each_of_27(v, [&](const Index& near) { all = all && is_free(near); });
        if (all) map_.at(v).ever_free = true;
      });
    }
  }

  /// E. Every voxel of every wide block that a ray meets.
  void integrate(const std::vector<Point>& points, const Pose& pose) {
    ThreadPool pool(1);
    const ScanPixels pixels = pixels_of(points, sensor_, pool);
    const RangeImage image = range_image(pixels, sensor_, static_cast<float>(config_.min_range_m));
    touched_ = blocks_on_rays(points, pixels, pose);
    const Eigen::Matrix3d turned = pose.linear().transpose();
    for (const Index& wide : touched_) {
      for_each_voxel(wide, [&](const Index& v) {
        const bool starts_now = config_.initial_last_occupied == InitialLastOccupied::kNow;
        TwinVoxel& voxel =
            map_.try_emplace(v, TwinVoxel{.last_occupied = starts_now ? frame_ : 0}).first->second;
        add(voxel, place_of(v, turned, pose), image);
      });
    }
  }

  /// The centre in the sensor frame, rounded as in the method.
  std::array<float, 3> place_of(const Index& v, const Eigen::Matrix3d& turned,
                                const Pose& pose) const {
    const Eigen::Vector3d first(static_cast<double>(v[2] >> 3 << 3),
                                static_cast<double>(v[1] >> 3 << 3),
                                static_cast<double>(v[0] >> 3 << 3));
    const Eigen::Vector3d corner_m = first * config_.voxel_size_m;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(config_.voxel_size_m / 2);
    const Eigen::Vector3d first_m = turned * (corner_m + half - pose.translation());
    std::array<float, 3> place{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto step = [&](int along) {
        return static_cast<float>(turned(axis, along) * config_.voxel_size_m);
      };
      const float start =
          static_cast<float>(first_m[axis]) +
          (static_cast<float>(v[1] & 7) * step(1) + static_cast<float>(v[0] & 7) * step(2));
      place[static_cast<std::size_t>(axis)] = start + static_cast<float>(v[2] & 7) * step(0);
    }
    return place;
  }

  void add(TwinVoxel& voxel, const std::array<float, 3>& p, const RangeImage& image) const {
    const float flat_sq = p[0] * p[0] + p[1] * p[1];
    const float range_sq = flat_sq + p[2] * p[2];
    const float range = std::sqrt(range_sq);
    if (range < static_cast<float>(config_.min_range_m) ||
        range > static_cast<float>(config_.max_range_m)) {
      return;
    }
    const auto [h, w] = place_in_image(sensor_, {p[0], p[1], p[2], 0});
    if (h < 0 || h > static_cast<float>(sensor_.rows - 1) || w <= 0 ||
        w >= static_cast<float>(sensor_.columns - 1))
      return;
    const float tau = config_.truncation_m(), v = static_cast<float>(config_.voxel_size_m);
    const float sdf = depth_at(image, {h, w}, 0.5F * tau) - range;
    if (sdf < -tau) return;
    float k = static_cast<float>(sensor_.rays_per_voxel_at_1m(config_.voxel_size_m)) / range_sq;
    if (sdf < -v) k = std::max(0.0F, k * (tau + sdf) / (tau - v));
    const float sum = voxel.w + k;
    if (sum <= 0) return;
    voxel.d += (std::min(tau, sdf) - voxel.d) * (k / sum);
    voxel.w = std::min(sum, static_cast<float>(config_.max_weight));
  }

  /// Steps along each ray that are far shorter than a block. Rays that pass an edge of a block by
  /// less than a step may miss one, which the tests of random rays tolerate by their seeds.
  std::set<Index> blocks_on_rays(const std::vector<Point>& points, const ScanPixels& pixels,
                                 const Pose& pose) const {
    std::set<Index> blocks;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float range_m = pixels.ranges_m[i];
      if (pixels.pixels[i] == kNoPixel || range_m < static_cast<float>(config_.min_range_m) ||
          range_m > static_cast<float>(config_.max_range_m)) {
        continue;
      }
      const Eigen::Vector3d ray = pose.linear() *
                                  Eigen::Vector3d(points[i].x, points[i].y, points[i].z) *
                                  (1 + config_.truncation_m() / range_m);
      constexpr int kSteps = 4000;
      for (int step = 0; step <= kSteps; ++step) {
        const Eigen::Vector3d at = pose.translation() + ray * step / kSteps;
        const auto cell = [&](int axis) {
          return static_cast<long>(std::floor(at[axis] / (16 * config_.voxel_size_m)));
        };
        blocks.insert({cell(2), cell(1), cell(0)});
      }
    }
    return blocks;
  }

  template <typename Visit>
  static void for_each_voxel(const Index& wide, Visit&& visit) {
    for (long z = 0; z < 16; ++z) {
      for (long y = 0; y < 16; ++y) {
        for (long x = 0; x < 16; ++x) {
          visit(Index{wide[0] * 16 + z, wide[1] * 16 + y, wide[2] * 16 + x});
        }
      }
    }
  }

  Config config_;
  SensorModel sensor_;
  long frame_ = 0;
  std::map<Index, TwinVoxel> map_;
  std::set<Index> touched_;
};

}  // namespace mosbench::dynablox_twin
