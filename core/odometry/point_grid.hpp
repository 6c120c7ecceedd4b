#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench::odometry {

/// The nearest point of a grid to some position.
struct Neighbour {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< without meaning when none was found
  double distance_m = std::numeric_limits<double>::infinity();  ///< infinite when none was found
  /// All other points are at least this far from the position; all points when none was found.
  double others_m = 0;
};

/// Points in cubic cells, found by a hash of blocks of 4x4x4 cells. Positions may be anywhere:
/// indices wrap after 2^23 cells, which is right as long as the points lie less than half of that
/// apart.
class PointGrid {
 public:
  explicit PointGrid(double cell_m);

  std::size_t size() const { return nodes_.size(); }
  double cell_m() const { return cell_m_; }
  std::size_t memory_bytes() const;

  void insert(const Eigen::Vector3d& point_m);
  /// Removes everything.
  void clear();
  /// Keeps the points with |point - centre| < radius.
  void keep_within(const Eigen::Vector3d& centre_m, double radius_m);

  /// Whether |point - position| < radius for a point, which is copied to `found`. At most a cell's
  /// edge.
  bool any_within(const Eigen::Vector3d& position_m, double radius_m, Eigen::Vector3d& found) const;

  /// Whether a point lies in the cell of the position.
  bool holds_cell_of(const Eigen::Vector3d& position_m) const;

  /// The nearest point if it is not farther than `reach_m`; a farther one may be found or not.
  Neighbour nearest(const Eigen::Vector3d& position_m, double reach_m) const;
  /// The nearest point in the cell of the position and the 26 around it.
  Neighbour nearest_in_27_cells(const Eigen::Vector3d& position_m) const;

  /// Calls visit(point) for the points in the cell of the position.
  template <typename Visit>
  void for_each_in_cell(const Eigen::Vector3d& position_m, Visit&& visit) const {
    const Cell cell = cell_of(position_m);
    visit_cells(cell, cell, visit);
  }
  /// Calls visit(point) for the points of all cells that touch the cube of half edge `reach_m`.
  template <typename Visit>
  void for_each_near(const Eigen::Vector3d& position_m, double reach_m, Visit&& visit) const {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(reach_m);
    visit_cells(cell_of(position_m - reach), cell_of(position_m + reach), visit);
  }
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (const Node& node : nodes_) visit(position_of(node));
  }

 private:
  struct Cell {
    std::int64_t x, y, z;
  };
  struct Node {
    double x, y, z;
    std::uint32_t next;  // of the same cell, or kNoSlot
  };
  struct Block {
    std::uint64_t mask = 0;  // bit z * 16 + y * 4 + x: the cell holds points
    std::array<std::uint32_t, 64> heads;
  };

  static Eigen::Vector3d position_of(const Node& node) { return {node.x, node.y, node.z}; }
  Cell cell_of(const Eigen::Vector3d& position_m) const;
  static BlockIndex block_of(std::int64_t x, std::int64_t y, std::int64_t z);
  static std::uint64_t cells_between(int axis, std::int64_t block, std::int64_t low,
                                     std::int64_t high);
  void link(std::uint32_t index);
  double blocks_within(double radius_m) const;
  double distance_out_of_27_cells(const Eigen::Vector3d& position_m) const;
  Neighbour search_cube(const Eigen::Vector3d& position_m, double radius_m) const;

  template <typename Visit>
  void visit_cells(const Cell& low, const Cell& high, Visit&& visit) const;

  double cell_m_, cells_per_m_;
  std::vector<Node> nodes_;
  std::vector<Block> blocks_;
  BlockTable table_;
};

template <typename Visit>
void PointGrid::visit_cells(const Cell& low, const Cell& high, Visit&& visit) const {
  for (std::int64_t z = low.z >> 2; z <= high.z >> 2; ++z) {
    const std::uint64_t layers = cells_between(2, z, low.z, high.z);
    for (std::int64_t y = low.y >> 2; y <= high.y >> 2; ++y) {
      const std::uint64_t rows = layers & cells_between(1, y, low.y, high.y);
      for (std::int64_t x = low.x >> 2; x <= high.x >> 2; ++x) {
        const std::uint32_t slot = table_.find(block_of(x, y, z));
        if (slot == kNoSlot) continue;
        const Block& block = blocks_[slot];
        std::uint64_t cells = block.mask & rows & cells_between(0, x, low.x, high.x);
        for (; cells != 0; cells &= cells - 1) {
          const auto cell = static_cast<std::size_t>(std::countr_zero(cells));
          for (std::uint32_t i = block.heads[cell]; i != kNoSlot; i = nodes_[i].next) {
            visit(position_of(nodes_[i]));
          }
        }
      }
    }
  }
}

/// The points, in order, that have no kept point nearer than `radius_m` (strictly) before them.
std::vector<Eigen::Vector3d> thinned(std::span<const Eigen::Vector3d> points_m, double radius_m);

/// Inserts in order those points that have no point of the grid nearer than `radius_m` (strictly),
/// which is at most the edge of its cells. Returns the positions of the inserted ones in
/// `points_m`.
std::vector<std::size_t> insert_apart(std::span<const Eigen::Vector3d> points_m, double radius_m,
                                      PointGrid& grid);

/// The first point of every cell of edge `cell_m`, in order.
std::vector<Eigen::Vector3d> first_of_cells(std::span<const Eigen::Vector3d> points_m,
                                            double cell_m);

/// The first point and every n-th after it.
std::vector<Eigen::Vector3d> every_nth(std::span<const Eigen::Vector3d> points_m, std::size_t n);

}  // namespace mosbench::odometry
