#include "core/tracks/low_points.hpp"

#include <limits>

#include "core/tracks/cells.hpp"

namespace mosbench::tracks {

std::vector<std::uint8_t> low_points(std::span<const Eigen::Vector3f> positions_m) {
  constexpr float kSide_m = 1, kLow_m = 0.2F;
  CellMap<std::uint32_t> number_of;
  std::vector<Cell> cells;
  std::vector<float> lowest_m;
  std::vector<std::uint32_t> numbers;
  numbers.reserve(positions_m.size());
  for (const Eigen::Vector3f& position : positions_m) {
    const Cell cell = cell_of(position, kSide_m);
    const auto [found, is_new] =
        number_of.try_emplace(cell, static_cast<std::uint32_t>(cells.size()));
    if (is_new) {
      cells.push_back(cell);
      lowest_m.push_back(std::numeric_limits<float>::infinity());
    }
    lowest_m[found->second] = std::min(lowest_m[found->second], position.z());
    numbers.push_back(found->second);
  }
  std::vector<float> around_m = lowest_m;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for_cells_around(cells[i], 1, [&](const Cell& cell) {
      const auto found = number_of.find(cell);
      if (found != number_of.end()) around_m[i] = std::min(around_m[i], lowest_m[found->second]);
    });
  }
  std::vector<std::uint8_t> low;
  low.reserve(positions_m.size());
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    low.push_back(positions_m[i].z() < around_m[numbers[i]] + kLow_m ? 1 : 0);
  }
  return low;
}

}  // namespace mosbench::tracks
