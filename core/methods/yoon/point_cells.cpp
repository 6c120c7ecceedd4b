#include "core/methods/yoon/point_cells.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench::yoon {

PointCells::PointCells(std::span<const Eigen::Vector3f> points, std::span<const std::uint8_t> taken,
                       double edge_m)
    : edge_m_(edge_m) {
  std::vector<std::uint32_t> slot_of(points.size(), kNoSlot);
  std::vector<std::uint32_t> counts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (taken[i] == 0) continue;
    const auto fresh = static_cast<std::uint32_t>(counts.size());
    slot_of[i] = slots_.find_or_insert(cell_of(points[i]), fresh);
    if (slot_of[i] == fresh) counts.push_back(0);
    ++counts[slot_of[i]];
  }
  std::uint32_t next = 0;
  for (const std::uint32_t count : counts) {
    cells_.push_back({next, next});
    next += count;
  }
  indices_.resize(next);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (slot_of[i] != kNoSlot) indices_[cells_[slot_of[i]].last++] = static_cast<std::uint32_t>(i);
  }
}

BlockIndex PointCells::cell_of(const Eigen::Vector3f& position) const {
  const auto index = [&](float c) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(c) / edge_m_));
  };
  return {index(position.x()), index(position.y()), index(position.z())};
}

double PointCells::least_sq_m2(const Eigen::Vector3f& position, const BlockIndex& cell) const {
  // More than distances in single precision are rounded by.
  constexpr double kLess = 0.9999;
  const auto gap_sq = [&](float c, std::int32_t index) {
    const double gap_m = std::max(index * edge_m_ - c, c - (index + 1) * edge_m_);
    return gap_m > 0 ? gap_m * gap_m : 0;
  };
  return kLess * (gap_sq(position.x(), cell.x) + gap_sq(position.y(), cell.y) +
                  gap_sq(position.z(), cell.z));
}

}  // namespace mosbench::yoon
