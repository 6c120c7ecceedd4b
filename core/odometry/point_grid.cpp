#include "core/odometry/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mosbench::odometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Keeps the smallest and the second smallest squared distance.
struct TwoNearest {
  const Eigen::Vector3d& position_m;
  Neighbour nearest;
  double best_sq_m2 = kInfinity, second_sq_m2 = kInfinity;

  void operator()(const Eigen::Vector3d& point_m) {
    const double distance_sq_m2 = (point_m - position_m).squaredNorm();
    if (distance_sq_m2 < best_sq_m2) {
      second_sq_m2 = best_sq_m2;
      best_sq_m2 = distance_sq_m2;
      nearest.point_m = point_m;
    } else {
      second_sq_m2 = std::min(second_sq_m2, distance_sq_m2);
    }
  }

  /// The answer when every point nearer than `searched_m` was seen.
  Neighbour answer(double searched_m) {
    nearest.distance_m = std::sqrt(best_sq_m2);
    nearest.others_m = std::min(std::sqrt(second_sq_m2), searched_m);
    return nearest;
  }
};

}  // namespace

PointGrid::PointGrid(double cell_m) : cell_m_(cell_m), cells_per_m_(1.0 / cell_m) {}

std::size_t PointGrid::memory_bytes() const {
  return nodes_.capacity() * sizeof(Node) + blocks_.capacity() * sizeof(Block) +
         table_.memory_bytes();
}

PointGrid::Cell PointGrid::cell_of(const Eigen::Vector3d& position_m) const {
  const auto index = [&](double m) {
    return static_cast<std::int64_t>(std::floor(m * cells_per_m_));
  };
  return {index(position_m.x()), index(position_m.y()), index(position_m.z())};
}

BlockIndex PointGrid::block_of(std::int64_t x, std::int64_t y, std::int64_t z) {
  // The table takes 21 bits with sign.
  const auto wrap = [](std::int64_t i) {
    return static_cast<std::int32_t>(((i + (1 << 20)) & ((1 << 21) - 1)) - (1 << 20));
  };
  return {wrap(x), wrap(y), wrap(z)};
}

std::uint64_t PointGrid::cells_between(int axis, std::int64_t block, std::int64_t low,
                                       std::int64_t high) {
  static constexpr std::array<std::uint64_t, 3> kFirst = {0x1111111111111111u, 0x000F000F000F000Fu,
                                                          0x000000000000FFFFu};
  static constexpr std::array<int, 3> kStep = {1, 4, 16};
  const auto axis_index = static_cast<std::size_t>(axis);
  const std::int64_t from = std::max<std::int64_t>(low - block * 4, 0);
  const std::int64_t to = std::min<std::int64_t>(high - block * 4, 3);
  std::uint64_t cells = 0;
  for (std::int64_t i = from; i <= to; ++i) cells |= kFirst[axis_index] << (i * kStep[axis_index]);
  return cells;
}

void PointGrid::link(std::uint32_t index) {
  Node& node = nodes_[index];
  const Cell cell = cell_of(position_of(node));
  const auto fresh = static_cast<std::uint32_t>(blocks_.size());
  const std::uint32_t slot =
      table_.find_or_insert(block_of(cell.x >> 2, cell.y >> 2, cell.z >> 2), fresh);
  if (slot == fresh) blocks_.emplace_back();
  Block& block = blocks_[slot];
  const auto bit = static_cast<std::size_t>((cell.z & 3) * 16 + (cell.y & 3) * 4 + (cell.x & 3));
  const std::uint64_t flag = std::uint64_t{1} << bit;
  node.next = (block.mask & flag) != 0 ? block.heads[bit] : kNoSlot;
  block.heads[bit] = index;
  block.mask |= flag;
}

void PointGrid::insert(const Eigen::Vector3d& point_m) {
  nodes_.push_back({point_m.x(), point_m.y(), point_m.z(), kNoSlot});
  link(static_cast<std::uint32_t>(nodes_.size() - 1));
}

void PointGrid::clear() {
  nodes_.clear();
  blocks_.clear();
  table_.clear();
}

void PointGrid::keep_within(const Eigen::Vector3d& centre_m, double radius_m) {
  const std::size_t before = nodes_.size();
  std::erase_if(nodes_, [&](const Node& node) {
    return !((position_of(node) - centre_m).squaredNorm() < radius_m * radius_m);
  });
  if (nodes_.size() == before) return;
  blocks_.clear();
  table_.clear();
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) link(i);
}

bool PointGrid::any_within(const Eigen::Vector3d& position_m, double radius_m,
                           Eigen::Vector3d& found) const {
  const double radius_sq_m2 = radius_m * radius_m;
  bool any = false;
  const auto test = [&](const Eigen::Vector3d& point_m) {
    if (any || !((point_m - position_m).squaredNorm() < radius_sq_m2)) return;
    any = true;
    found = point_m;
  };
  for_each_in_cell(position_m, test);
  if (!any) for_each_near(position_m, radius_m, test);
  return any;
}

bool PointGrid::holds_cell_of(const Eigen::Vector3d& position_m) const {
  bool any = false;
  for_each_in_cell(position_m, [&](const Eigen::Vector3d&) { any = true; });
  return any;
}

Neighbour PointGrid::nearest_in_27_cells(const Eigen::Vector3d& position_m) const {
  const Cell cell = cell_of(position_m);
  TwoNearest two{position_m, {}};
  visit_cells({cell.x - 1, cell.y - 1, cell.z - 1}, {cell.x + 1, cell.y + 1, cell.z + 1}, two);
  return two.answer(distance_out_of_27_cells(position_m));
}

double PointGrid::distance_out_of_27_cells(const Eigen::Vector3d& position_m) const {
  const Eigen::Array3d cells = position_m.array() * cells_per_m_;
  const Eigen::Array3d part = cells - cells.floor();
  return cell_m_ * (1.0 + part.min(1.0 - part).minCoeff());
}

double PointGrid::blocks_within(double radius_m) const {
  const double edge = 2.0 * radius_m / (4.0 * cell_m_) + 1.0;
  return edge * edge * edge;
}

Neighbour PointGrid::search_cube(const Eigen::Vector3d& position_m, double radius_m) const {
  TwoNearest two{position_m, {}};
  if (blocks_within(radius_m) > static_cast<double>(nodes_.size())) {
    for_each([&](const Eigen::Vector3d& point_m) { two(point_m); });
    return two.answer(kInfinity);
  }
  for_each_near(position_m, radius_m, [&](const Eigen::Vector3d& point_m) { two(point_m); });
  return two.answer(radius_m);
}

Neighbour PointGrid::nearest(const Eigen::Vector3d& position_m, double reach_m) const {
  Neighbour neighbour = nearest_in_27_cells(position_m);
  double searched_m = distance_out_of_27_cells(position_m);
  // Cubes grow until one holds its own nearest point.
  while (neighbour.distance_m > searched_m && searched_m < reach_m) {
    searched_m =
        std::isfinite(neighbour.distance_m) ? neighbour.distance_m * 1.25 : 2.0 * searched_m;
    searched_m = std::min(searched_m, reach_m * 1.25);
    neighbour = search_cube(position_m, searched_m);
    if (neighbour.others_m > searched_m) return neighbour;  // has seen all points
  }
  if (neighbour.distance_m > searched_m) {
    neighbour.distance_m = kInfinity;
    neighbour.others_m = searched_m;
  }
  return neighbour;
}

std::vector<std::size_t> insert_apart(std::span<const Eigen::Vector3d> points_m, double radius_m,
                                      PointGrid& grid) {
  std::vector<std::size_t> inserted;
  // Points next to one another in a file mostly lie next to one another: the point that was in the
  // way of the one before is tried first.
  Eigen::Vector3d in_the_way = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const Eigen::Vector3d& point_m = points_m[i];
    if ((in_the_way - point_m).squaredNorm() < radius_m * radius_m) continue;
    if (grid.any_within(point_m, radius_m, in_the_way)) continue;
    grid.insert(point_m);
    inserted.push_back(i);
    in_the_way = point_m;
  }
  return inserted;
}

std::vector<Eigen::Vector3d> thinned(std::span<const Eigen::Vector3d> points_m, double radius_m) {
  PointGrid grid(radius_m);
  std::vector<Eigen::Vector3d> kept;
  for (const std::size_t i : insert_apart(points_m, radius_m, grid)) kept.push_back(points_m[i]);
  return kept;
}

std::vector<Eigen::Vector3d> first_of_cells(std::span<const Eigen::Vector3d> points_m,
                                            double cell_m) {
  PointGrid grid(cell_m);
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector3d& point_m : points_m) {
    if (grid.holds_cell_of(point_m)) continue;
    grid.insert(point_m);
    kept.push_back(point_m);
  }
  return kept;
}

std::vector<Eigen::Vector3d> every_nth(std::span<const Eigen::Vector3d> points_m, std::size_t n) {
  std::vector<Eigen::Vector3d> kept;
  for (std::size_t i = 0; i < points_m.size(); i += n) kept.push_back(points_m[i]);
  return kept;
}

}  // namespace mosbench::odometry
