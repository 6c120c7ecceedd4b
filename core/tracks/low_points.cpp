#include "core/tracks/low_points.hpp"

#include <limits>

#include "core/tracks/cells.hpp"

namespace mosbench::tracks {

std::vector<std::uint8_t> low_points(std::span<const Eigen::Vector3f> positions_m,
                                     std::span<const std::uint8_t> part) {
  constexpr float kSide_m = 1, kLow_m = 0.2F;
  CellMap<std::uint32_t> number_of;
  std::vector<Cell> cells;
  std::vector<float> lowest_m;
  std::vector<std::uint32_t> numbers;
  numbers.reserve(positions_m.size());
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    numbers.push_back(0);
    if (part[i] == 0) continue;
    const Eigen::Vector3f& position = positions_m[i];
    const Cell cell = cell_of(position, kSide_m);
    const auto [found, is_new] =
        number_of.try_emplace(cell, static_cast<std::uint32_t>(cells.size()));
    if (is_new) {
      cells.push_back(cell);
      lowest_m.push_back(std::numeric_limits<float>::infinity());
    }
    lowest_m[found->second] = std::min(lowest_m[found->second], position.z());
    numbers.back() = found->second;
  }
  std::vector<float> around_m = lowest_m;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for_cells_around(cells[i], 1, [&](const Cell& cell) {
      const auto found = number_of.find(cell);
      if (found != number_of.end()) around_m[i] = std::min(around_m[i], lowest_m[found->second]);
    });
  }
  std::vector<std::uint8_t> low(positions_m.size());
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    if (part[i] != 0 && positions_m[i].z() < around_m[numbers[i]] + kLow_m) low[i] = 1;
  }
  return low;
}

}  // namespace mosbench::tracks
