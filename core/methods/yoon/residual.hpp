#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench::yoon {

/// Points sorted into cubic cells, for searches no farther than a cell's edge.
class PointCells {
 public:
  /// `taken` holds a flag per point; others are left out.
  PointCells(std::span<const Eigen::Vector3f> points, std::span<const std::uint8_t> taken,
             double edge_m);

  /// Calls visit(index) for every point in the cells around a position that may be within
  /// sqrt(reach_sq_m2()), which may shrink meanwhile; those of the position's own cell come first.
  template <typename Reach, typename Visit>
  void for_each_near(const Eigen::Vector3f& position, Reach&& reach_sq_m2, Visit&& visit) const {
    const auto visit_cell = [&](const BlockIndex& index) {
      const std::uint32_t slot = slots_.find(index);
      if (slot == kNoSlot) return;
      for (std::uint32_t i = cells_[slot].first; i < cells_[slot].last; ++i) visit(indices_[i]);
    };
    const BlockIndex own = cell_of(position);
    visit_cell(own);
    for_each_neighbour(own, [&](std::size_t, const BlockIndex& index) {
      if (index != own && least_sq_m2(position, index) <= reach_sq_m2()) visit_cell(index);
    });
  }

  /// Calls takes(index) for every point in the 27 cells around a position, and removes those for
  /// which it returns true.
  template <typename Takes>
  void take_around(const Eigen::Vector3f& position, Takes&& takes) {
    for_each_neighbour(cell_of(position), [&](std::size_t, const BlockIndex& index) {
      const std::uint32_t slot = slots_.find(index);
      if (slot == kNoSlot) return;
      Cell& cell = cells_[slot];
      for (std::uint32_t i = cell.first; i < cell.last;) {
        if (takes(indices_[i])) {
          std::swap(indices_[i], indices_[--cell.last]);
        } else {
          ++i;
        }
      }
    });
  }

 private:
  /// Where the points of a cell are in `indices_`.
  struct Cell {
    std::uint32_t first = 0, last = 0;
  };

  BlockIndex cell_of(const Eigen::Vector3f& position) const;
  /// Returns less than the squared distance to any point in a cell.
  double least_sq_m2(const Eigen::Vector3f& position, const BlockIndex& cell) const;

  double edge_m_;
  BlockTable slots_;
  std::vector<Cell> cells_;  ///< per slot
  std::vector<std::uint32_t> indices_;
};

/// How far a point is from a reference scan.
struct Residual {
  float distance_m;  ///< to the plane of the ten nearest points, else to the nearest one
  bool to_plane;
};

/// Residuals end here: nothing is looked for farther away.
inline constexpr float kFarthest_m = 0.6F;

/// Returns the residual of a point. `reference` are the points in `cells`, whose edge is
/// kFarthest_m. Ten points are a plane when the smallest eigenvalue of their covariance is less
/// than `planar_share` of the sum.
Residual residual_of(const Eigen::Vector3f& point, std::span<const Eigen::Vector3f> reference,
                     const PointCells& cells, double planar_share);

}  // namespace mosbench::yoon
