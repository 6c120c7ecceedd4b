#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxel/voxel_set.hpp"

namespace mosbench::yoon {

/// Points sorted into cubic cells, for searches no farther than a cell's edge.
class PointCells {
 public:
  /// `taken` holds a flag per point; others are left out.
  PointCells(std::span<const Eigen::Vector3f> points, std::span<const std::uint8_t> taken,
             double edge_m);

  /// Calls visit(index) for every point in the 27 cells around a position: all those within the
  /// edge of a cell, and others, in an order that depends on the points alone.
  template <typename Visit>
  void for_each_around(const Eigen::Vector3f& position, Visit&& visit) const {
    for_each_neighbour(cell_of(position), [&](std::size_t, const BlockIndex& cell) {
      const std::uint32_t slot = slots_.find(cell);
      if (slot == kNoSlot) return;
      for (std::uint32_t i = first_[slot]; i < first_[slot + 1]; ++i) visit(indices_[i]);
    });
  }

 private:
  BlockIndex cell_of(const Eigen::Vector3f& position) const;

  double edge_m_;
  BlockTable slots_;
  std::vector<std::uint32_t> first_;  ///< per slot; one more at the end
  std::vector<std::uint32_t> indices_;
};

}  // namespace mosbench::yoon
