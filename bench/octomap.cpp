#include <octomap/octomap.h>

#include "bench/stage_benchmark.hpp"
#include "core/methods/octomap/log_odds_map.hpp"

/// The update of OctoMap's map by our rays and block by block, beside the library's own
/// insertPointCloud: the same leaves. Times of the two compare within one run of the program.
namespace mosbench {
namespace {

octomap::Config octomap_config(const StagedScans& staged) {
  octomap::Config config;
  config.voxel_size_m = staged.workload.config.voxel_size_m;
  config.min_range_m = staged.workload.config.min_range_m;
  config.max_range_m = staged.workload.config.max_range_m;
  return config;
}

/// A scan as both take it, made beforehand.
struct OctomapScan {
  PosedScan posed;
  ::octomap::Pointcloud cloud;
  ::octomap::point3d sensor;
};

std::vector<OctomapScan> octomap_scans(const StagedScans& staged, const VoxelGrid& grid,
                                       double min_range_m) {
  const Eigen::Vector3d origin_m = grid.origin_voxels * grid.voxel_size_m;
  std::vector<OctomapScan> scans;
  for (const StagedScan& s : staged.all) {
    OctomapScan& scan = scans.emplace_back();
    const Pose& pose = scan.posed.map_from_sensor = s.frame.map_from_sensor;
    scan.posed.points = s.frame.points;
    const Eigen::Vector3d sensor_m = pose.translation() - origin_m;
    const auto point_of = [](const Eigen::Vector3d& p_m) {
      const Eigen::Vector3f p = p_m.cast<float>();
      return ::octomap::point3d(p.x(), p.y(), p.z());
    };
    scan.sensor = point_of(sensor_m);
    for (const Point& p : s.frame.points) {
      const Eigen::Vector3d in_sensor(p.x, p.y, p.z);
      if (!(in_sensor.norm() > min_range_m)) continue;
      scan.cloud.push_back(point_of(pose.linear() * in_sensor + sensor_m));
    }
  }
  return scans;
}

/// The library's map, with its own way in.
class LibraryMap {
 public:
  explicit LibraryMap(const octomap::Config& config)
      : tree_(config.voxel_size_m), max_range_m_(config.max_range_m) {
    tree_.setProbHit(config.hit_probability);
    tree_.setProbMiss(config.miss_probability);
    tree_.setClampingThresMin(config.lowest_probability);
    tree_.setClampingThresMax(config.highest_probability);
  }

  bool enter(const OctomapScan& scan) {
    tree_.insertPointCloud(scan.cloud, scan.sensor, max_range_m_, true);
    return true;
  }
  std::size_t leaf_count() const { return tree_.getNumLeafNodes(); }

 private:
  ::octomap::OcTree tree_;
  double max_range_m_;
};

/// Ours, on one thread or several.
class BlockwiseMap {
 public:
  BlockwiseMap(const octomap::Config& config, const VoxelGrid& grid, ThreadPool& pool)
      : config_(config), grid_(grid), pool_(pool), map_(config) {}

  bool enter(const OctomapScan& scan) {
    map_.enter(octomap::update_of(scan.posed, grid_, config_, windows_, pool_));
    return true;
  }
  std::size_t leaf_count() const { return map_.leaves().size(); }

 private:
  octomap::Config config_;
  VoxelGrid grid_;
  ThreadPool& pool_;
  octomap::LogOddsMap map_;
  std::vector<RayWindow> windows_;
};

/// Enters all scans of the workload from the first into a fresh map; one call is one scan on
/// average. Returns how many leaves the last map has.
template <typename Make>
std::size_t enter_all(benchmark::State& state, const std::vector<OctomapScan>& scans, Make&& make) {
  std::size_t leaves = 0;
  measure_passes(state, scans.size(), [&] {
    auto map = make();
    for (const OctomapScan& scan : scans) timed_call(state, [&] { return map->enter(scan); });
    leaves = map->leaf_count();
  });
  return leaves;
}

std::size_t leaves_of_library(const std::vector<OctomapScan>& scans,
                              const octomap::Config& config) {
  LibraryMap map(config);
  for (const OctomapScan& scan : scans) map.enter(scan);
  return map.leaf_count();
}

void octomap_blockwise(benchmark::State& state, StagedScans& staged, ThreadPool& pool) {
  const octomap::Config config = octomap_config(staged);
  const auto scans = octomap_scans(staged, staged.grid, config.min_range_m);
  const std::size_t leaves = enter_all(
      state, scans, [&] { return std::make_unique<BlockwiseMap>(config, staged.grid, pool); });
  expect(state, leaves > 0 && leaves == leaves_of_library(scans, config));
  count_items(state, "points", mean_points(staged));
}

void octomap_library(benchmark::State& state, StagedScans& staged, ThreadPool&) {
  const octomap::Config config = octomap_config(staged);
  const auto scans = octomap_scans(staged, staged.grid, config.min_range_m);
  expect(state, enter_all(state, scans, [&] { return std::make_unique<LibraryMap>(config); }) > 0);
  count_items(state, "points", mean_points(staged));
}

}  // namespace

std::vector<BenchmarkRow> octomap_rows() {
  return {{"octomap_blockwise", octomap_blockwise, true},
          {"octomap_insertPointCloud", octomap_library, false}};
}

}  // namespace mosbench
