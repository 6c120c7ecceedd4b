#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "core/methods/hmm_mos_plus/attachments.hpp"

namespace mosbench::hmm_mos_plus {
namespace {

/// A row of ten voxels along x that is a component, and rows beside it that are settled.
struct RowBesideOthers {
  int voxels = 10, arrived = 0, open = 0;
  int settled = 10, settled_at_y = 2;  ///< 0.6 m are two voxels
  int steady_steps = 0;
  bool low = false;
  int last_z = 0;  ///< of its last voxel
  int left = 0;    ///< voxels of it that were left
};

/// A map in which some voxels of the row were occupied and are free.
struct MapOfLeft {
  explicit MapOfLeft(int left) {
    VoxelSet row, elsewhere;
    elsewhere.masks[elsewhere.insert(block_of({100, 0, 0}))].set(cell_of({100, 0, 0}));
    for (int x = 0; x < left; ++x)
      row.masks[row.insert(block_of({x, 0, 0}))].set(cell_of({x, 0, 0}));
    VoxelList observed{row.blocks, row.masks};
    for (std::uint32_t k = 0; k < 10; ++k) {
      const std::array<const VoxelSet*, 1> sources = {k < 5 && left > 0 ? &row : &elsewhere};
      map.update(observed, sources, Eigen::Vector3d::Zero(), k, pool);
    }
  }

  RememberedMap remembered() { return {map, memory, 9}; }

  ThreadPool pool{1};
  BlockMemory memory;
  hmm_mos::VoxelMap map{Config{}.map, grid_around(Eigen::Vector3d::Zero(), 0.25), &memory};
};

/// Whether a row moves in the last of some scans, each with its tick.
bool moves_last(const std::vector<std::pair<std::uint32_t, RowBesideOthers>>& scans) {
  Config config;
  config.map.voxel_size_m = 0.25;
  config.ground_radius_voxels = kBlockSide;
  Attachments attachments(config);
  bool moves = false;
  for (const auto& [at, row] : scans) {
    VoxelizedScan scan;
    const auto add = [&](const Voxel& v) {
      const std::uint32_t slot = scan.measured.insert(block_of(v));
      scan.measured.masks[slot].set(cell_of(v));
      return slot;
    };
    Component component{.voxels = {}, .moves = true, .steady_steps = row.steady_steps};
    for (int x = 0; x < row.voxels; ++x) {
      const Voxel v{x, 0, x + 1 == row.voxels ? row.last_z : 0};
      component.voxels.push_back(add(v) * kBlockVoxels + cell_of(v));
    }
    for (int x = 0; x < row.settled; ++x) add({x, row.settled_at_y, 0});
    for (int x = 0; x < 10; x += 5) add({x, 0, row.low ? 0 : -20});
    scan.occupied = scan.measured.masks;
    const ScanMasks none(scan.occupied.size());
    ArrivalClasses classes{none, none, none, none, none, none, none};
    for (int x = 0; x < row.arrived; ++x) {
      const std::uint32_t slot = scan.measured.find(block_of({x, 0, 0}));
      classes.arrived[slot].set(cell_of({x, 0, 0}));
      if (x < row.open) classes.open[slot].set(cell_of({x, 0, 0}));
    }
    for (int x = 0; x < row.settled; ++x) {
      const Voxel v{x, row.settled_at_y, 0};
      classes.settled[scan.measured.find(block_of(v))].set(cell_of(v));
    }
    const Ground ground(scan, config);
    LowVoxels low(scan, ground);
    std::vector<Component> components = {component};
    MapOfLeft map(row.left);
    attachments.judge(scan, classes, low, at, map.remembered(), components);
    moves = components.front().moves;
  }
  return moves;
}

bool moves(const RowBesideOthers& row) { return moves_last({{0, row}}); }

TEST(PlusAttachments, ArePartOfWhatStandsUnlessTheyArrived) {
  EXPECT_FALSE(moves({.arrived = 0}));
  EXPECT_FALSE(moves({.arrived = 7}));
  EXPECT_TRUE(moves({.arrived = 8}));
}

TEST(PlusAttachments, HaveEnoughSettledVoxelsNearThatAreNotLow) {
  EXPECT_TRUE(moves({.settled = 3}));
  EXPECT_FALSE(moves({.settled = 4}));
  EXPECT_FALSE(moves({.settled_at_y = -2}));
  EXPECT_TRUE(moves({.settled_at_y = 3}));
  EXPECT_TRUE(moves({.low = true}));
}

TEST(PlusAttachments, DoNotGoOnSteadily) {
  EXPECT_FALSE(moves({.steady_steps = 1}));
  EXPECT_TRUE(moves({.steady_steps = 2}));
}

TEST(PlusAttachments, AreToldByWhatWasNearInTheLastSecond) {
  const RowBesideOthers standing{.arrived = 0}, arrived{.voxels = 9, .arrived = 9, .settled = 0};
  EXPECT_TRUE(moves_last({{0, arrived}}));
  EXPECT_FALSE(moves_last({{0, standing}, {10, arrived}}));
  EXPECT_TRUE(moves_last({{0, standing}, {11, arrived}}));
}

TEST(PlusAttachments, LeaveNothingBehind) {
  const RowBesideOthers beside{.arrived = 8, .settled = 1};
  EXPECT_TRUE(moves_last({{0, beside}, {1, beside}})) << "it had no time to leave";
  EXPECT_FALSE(moves_last({{0, beside}, {2, beside}}));
  const RowBesideOthers gone{.arrived = 8, .settled = 1, .left = 1};
  EXPECT_TRUE(moves_last({{0, beside}, {2, gone}}));
  const RowBesideOthers alone{.arrived = 8, .settled = 0}, whole{.arrived = 9, .settled = 1};
  EXPECT_TRUE(moves_last({{0, alone}, {2, alone}}));
  EXPECT_TRUE(moves_last({{0, whole}, {2, whole}}));
  const RowBesideOthers in_view{.arrived = 2, .settled = 0}, enough{.arrived = 3, .settled = 0};
  EXPECT_TRUE(moves_last({{0, in_view}, {1, in_view}})) << "it had no time to leave";
  EXPECT_FALSE(moves_last({{0, in_view}, {2, in_view}}));
  EXPECT_TRUE(moves_last({{0, enough}, {2, enough}}));
}

TEST(PlusAttachments, WaitForASecondScanWhereTheyCameIntoView) {
  const RowBesideOthers seen{.arrived = 2, .settled = 0}, small{.voxels = 2, .arrived = 2};
  EXPECT_TRUE(moves_last({{7, seen}})) << "in the beginning everything comes into view";
  EXPECT_FALSE(moves_last({{8, seen}}));
  EXPECT_TRUE(moves_last({{8, seen}, {9, seen}}));
  EXPECT_TRUE(moves_last({{8, {.arrived = 3, .settled = 0}}}));
  EXPECT_FALSE(moves_last({{8, small}}));
  EXPECT_TRUE(moves_last({{8, small}, {9, small}}));
}

TEST(PlusAttachments, AreEdgesBetweenTwoBeamsWhereTheyAreSeenToBeFlat) {
  const RowBesideOthers edge{.arrived = 10, .open = 3};
  EXPECT_FALSE(moves(edge));
  EXPECT_TRUE(moves({.arrived = 10, .open = 2})) << "the next beams are far";
  EXPECT_TRUE(moves({.arrived = 10, .open = 3, .steady_steps = 2}));
  RowBesideOthers high = edge;
  high.last_z = 1;
  EXPECT_TRUE(moves(high));
  EXPECT_TRUE(moves_last({{0, high}, {10, edge}}));
  EXPECT_FALSE(moves_last({{0, high}, {11, edge}}));
}

}  // namespace
}  // namespace mosbench::hmm_mos_plus
