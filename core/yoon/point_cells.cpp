#include "core/yoon/point_cells.hpp"

#include <cmath>

namespace mosbench::yoon {

PointCells::PointCells(std::span<const Eigen::Vector3f> points, std::span<const std::uint8_t> taken,
                       double edge_m)
    : edge_m_(edge_m), first_(1) {
  std::vector<std::uint32_t> slot_of(points.size(), kNoSlot);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (taken[i] == 0) continue;
    const auto fresh = static_cast<std::uint32_t>(first_.size() - 1);
    slot_of[i] = slots_.find_or_insert(cell_of(points[i]), fresh);
    if (slot_of[i] == fresh) first_.push_back(0);
    ++first_[slot_of[i] + 1];
  }
  for (std::size_t slot = 1; slot < first_.size(); ++slot) first_[slot] += first_[slot - 1];
  indices_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (slot_of[i] != kNoSlot) indices_[next[slot_of[i]]++] = static_cast<std::uint32_t>(i);
  }
}

BlockIndex PointCells::cell_of(const Eigen::Vector3f& position) const {
  const auto index = [&](float c) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(c) / edge_m_));
  };
  return {index(position.x()), index(position.y()), index(position.z())};
}

}  // namespace mosbench::yoon
