#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace mosbench::tracks {

/// A square of the ground plan.
struct Cell {
  int x = 0, y = 0;
  bool operator==(const Cell&) const = default;
};

inline Cell cell_of(const Eigen::Vector3f& position_m, float side_m) {
  return {static_cast<int>(std::floor(position_m.x() / side_m)),
          static_cast<int>(std::floor(position_m.y() / side_m))};
}

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    const auto x = static_cast<std::uint32_t>(cell.x), y = static_cast<std::uint32_t>(cell.y);
    return (std::uint64_t{x} << 32 | y) * 0x9E3779B97F4A7C15U >> 20;
  }
};

/// Values by cell. It is never walked through: its order would be that of the machine.
template <typename Value>
using CellMap = std::unordered_map<Cell, Value, CellHash>;

/// Calls `visit` for the cells at most `reach` away along x and y. Takes the cell by value: `visit`
/// may grow the list that it is from.
template <typename Visit>
void for_cells_around(Cell cell, int reach, Visit&& visit) {
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) visit(Cell{cell.x + x, cell.y + y});
  }
}

}  // namespace mosbench::tracks
