#include "core/methods/yoon/residual.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace mosbench::yoon {
namespace {

constexpr std::size_t kPlanePoints = 10;

struct Neighbour {
  float distance_sq_m2;
  std::uint32_t index;

  bool operator<(const Neighbour& other) const {
    return distance_sq_m2 != other.distance_sq_m2 ? distance_sq_m2 < other.distance_sq_m2
                                                  : index < other.index;
  }
};

/// The nearest points, at most ten, the nearest first.
struct Nearest {
  std::array<Neighbour, kPlanePoints> points;
  std::size_t count = 0;

  /// Points farther than this are not among them.
  float reach_sq_m2() const {
    return count < kPlanePoints ? kFarthest_m * kFarthest_m : points.back().distance_sq_m2;
  }

  void add(const Neighbour& neighbour) {
    if (count == kPlanePoints && !(neighbour < points.back())) return;
    if (count < kPlanePoints) ++count;
    std::size_t place = count - 1;
    for (; place > 0 && neighbour < points[place - 1]; --place) points[place] = points[place - 1];
    points[place] = neighbour;
  }
};

Nearest nearest_to(const Eigen::Vector3f& point, std::span<const Eigen::Vector3f> reference,
                   const PointCells& cells) {
  Nearest nearest;
  cells.for_each_near(
      point, [&] { return nearest.reach_sq_m2(); },
      [&](std::uint32_t index) {
        const Eigen::Vector3f offset = reference[index] - point;
        const float distance_sq_m2 =
            (offset.x() * offset.x() + offset.y() * offset.y()) + offset.z() * offset.z();
        if (distance_sq_m2 < kFarthest_m * kFarthest_m) nearest.add({distance_sq_m2, index});
      });
  return nearest;
}

}  // namespace

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

Residual residual_of(const Eigen::Vector3f& point, std::span<const Eigen::Vector3f> reference,
                     const PointCells& cells, double planar_share) {
  const Nearest nearest = nearest_to(point, reference, cells);
  if (nearest.count == 0) return {kFarthest_m, false};
  const Residual to_point{std::sqrt(nearest.points[0].distance_sq_m2), false};
  if (nearest.count < kPlanePoints) return to_point;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Neighbour& n : nearest.points) mean += reference[n.index].cast<double>();
  mean /= static_cast<double>(kPlanePoints);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Neighbour& n : nearest.points) {
    const Eigen::Vector3d offset = reference[n.index].cast<double>() - mean;
    scatter += offset * offset.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter);
  // Eigenvalues rise.
  if (!(axes.eigenvalues()[0] < planar_share * axes.eigenvalues().sum())) return to_point;
  const double distance_m = std::abs((point.cast<double>() - mean).dot(axes.eigenvectors().col(0)));
  return {std::min(static_cast<float>(distance_m), kFarthest_m), true};
}

}  // namespace mosbench::yoon
