#include <gtest/gtest.h>

#include <array>
#include <set>

#include "core/methods/dufomap/pipeline.hpp"
#include "core/voxel/grid_walk.hpp"
#include "tests/small_world.hpp"

/// dufomap against sets of voxels, one ray and one voxel at a time.
namespace mosbench {
namespace {

using Cell = std::array<std::int32_t, 3>;

/// Grid coordinates of the sensor: metres from the grid's origin.
struct DufomapTwin {
  dufomap::Config config;
  VoxelGrid grid;
  std::set<Cell> ever_void;

  Cell cell_at(const Eigen::Vector3d& p_m) const {
    Cell cell;
    for (int i = 0; i < 3; ++i) {
      cell[static_cast<std::size_t>(i)] =
          static_cast<std::int32_t>(std::floor(p_m[i] / config.resolution_m));
    }
    return cell;
  }

  /// Visits the voxels from a position while visit returns true and the line is not over; then
  /// `beyond` more steps along one axis.
  template <typename Visit>
  void walk(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double length_m,
            int beyond, Visit&& visit) const {
    Cell cell = cell_at(from);
    BorderCrossings crossings(from, direction, {cell[0], cell[1], cell[2]}, config.resolution_m);
    const auto advance = [&] {
      const std::size_t axis = crossings.axis();
      cell[axis] += crossings.back[axis] ? -1 : 1;
      crossings.next_m[axis] += crossings.pace_m[axis];
      return axis;
    };
    bool goes_on = visit(cell);
    while (goes_on && crossings.nearest_m() < length_m) {
      advance();
      goes_on = visit(cell);
    }
    const Cell last = cell;
    if (beyond == 0) return;
    for (;;) {
      const std::size_t axis = advance();
      visit(cell);
      if (std::abs(cell[axis] - last[axis]) == beyond) return;
    }
  }

  void enter(const std::vector<Point>& points, const Pose& pose) {
    const Eigen::Vector3d sensor = pose.translation() - grid.origin_voxels * config.resolution_m;
    std::set<Cell> goals, hits, crossed;
    for (const Point& p : points) {
      if (const auto goal = cell_of_point(p, pose)) goals.insert(*goal);
    }
    const auto line_to = [&](const Cell& goal) -> Eigen::Vector3d {
      return Eigen::Vector3d(goal[0] + 0.5, goal[1] + 0.5, goal[2] + 0.5) * config.resolution_m -
             sensor;
    };
    for (const Cell& goal : goals) {
      const Eigen::Vector3d line = line_to(goal);
      if (line.norm() > config.max_range_m || line.norm() == 0) continue;
      const Eigen::Vector3d direction = line / line.norm();
      const Eigen::Vector3d from = sensor + line - direction * config.sensor_noise_m;
      walk(from, direction, config.sensor_noise_m, 0, [&](const Cell& cell) {
        hits.insert(cell);
        return true;
      });
      hits.insert(goal);
    }
    for (const Cell& goal : goals) {
      const Eigen::Vector3d line = line_to(goal);
      if (line.norm() == 0) continue;
      walk(sensor, line / line.norm(), std::min(line.norm(), config.max_range_m),
           config.pose_error_voxels, [&](const Cell& cell) {
             crossed.insert(cell);
             return !hits.contains(cell);
           });
    }
    for (const Cell& cell : crossed) {
      if (!hits.contains(cell) && all_seen_around(cell, crossed, hits)) ever_void.insert(cell);
    }
  }

  bool all_seen_around(const Cell& cell, const std::set<Cell>& crossed,
                       const std::set<Cell>& hits) const {
    const int d = config.pose_error_voxels;
    for (int x = -d; x <= d; ++x) {
      for (int y = -d; y <= d; ++y) {
        for (int z = -d; z <= d; ++z) {
          const Cell near{cell[0] + x, cell[1] + y, cell[2] + z};
          if (!crossed.contains(near) && !hits.contains(near)) return false;
        }
      }
    }
    return true;
  }

  std::optional<Cell> cell_of_point(const Point& p, const Pose& pose) const {
    const Eigen::Vector3d in_sensor(p.x, p.y, p.z);
    if (!in_sensor.allFinite()) return std::nullopt;
    const Eigen::Vector3d in_map = pose * in_sensor;
    // The distance as voxelize rounds it.
    const Eigen::Vector3d offset = in_map - pose.translation();
    if (!(offset.squaredNorm() > config.min_range_m * config.min_range_m)) return std::nullopt;
    Cell cell;
    for (int i = 0; i < 3; ++i) {
      cell[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(
          std::floor(in_map[i] / config.resolution_m) - grid.origin_voxels[i]);
    }
    return cell;
  }
};

TEST(DufomapAgainstSetsOfVoxels, AgreesOnlineAndAtTheEnd) {
  std::size_t moving = 0, sequences = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    dufomap::Config config;
    config.resolution_m = seed % 2 == 0 ? 0.4 : 0.5;
    config.sensor_noise_m = seed % 3 == 0 ? 0.0 : 0.6;
    config.pose_error_voxels = static_cast<int>(seed % 3);
    config.min_range_m = 0.3;
    config.max_range_m = seed % 4 == 1 ? 2.5 : 6.0;
    config.when = seed % 2 == 0 ? dufomap::When::kOnline : dufomap::When::kFinal;
    const SmallWorld world = small_world({.seed = seed,
                                          .scans = 10,
                                          .azimuths = 60,
                                          .elevations = 24,
                                          .origin_m = {seed % 2 == 0 ? 0.0 : -446'123.4, 12, 3},
                                          .defects = seed % 4 == 3});
    dufomap::Pipeline pipeline(config, {.threads = 1 + seed % 3});
    const std::vector<LabelledScan> results = results_of(pipeline, world);
    ASSERT_EQ(results.size(), world.scans.size());
    DufomapTwin twin{config, grid_around(world.poses[0].translation(), config.resolution_m), {}};
    const auto expect_labels = [&](std::size_t k) {
      for (std::size_t i = 0; i < world.scans[k].size(); ++i) {
        const Point& p = world.scans[k][i];
        const auto cell = twin.cell_of_point(p, world.poses[k]);
        const bool near = Eigen::Vector3d(p.x, p.y, p.z).norm() <= config.max_range_m;
        const bool moves = cell && near && twin.ever_void.contains(*cell);
        ASSERT_EQ(results[k].labels[i], moves ? kMovingLabel : kStaticLabel)
            << "seed " << seed << " scan " << k << " point " << i;
        moving += moves;
      }
    };
    for (std::size_t k = 0; k < world.scans.size(); ++k) {
      if (config.when == dufomap::When::kOnline) expect_labels(k);
      twin.enter(world.scans[k], world.poses[k]);
    }
    for (std::size_t k = 0; config.when == dufomap::When::kFinal && k < results.size(); ++k) {
      expect_labels(k);
    }
    ++sequences;
  }
  EXPECT_EQ(sequences, 10U);
  EXPECT_GT(moving, 500U);
}

}  // namespace
}  // namespace mosbench
