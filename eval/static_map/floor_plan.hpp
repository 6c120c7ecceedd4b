#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "eval/result/result_scans.hpp"
#include "eval/static_map/static_map.hpp"

namespace mosbench {

/// Heights above the ground, metres, in which a thing is in a robot's way.
struct HeightRange {
  double min_m = 0.2, max_m = 2.0;
};

/// Where a robot may drive, seen from above: the two files of ROS's map_server.
struct FloorPlan {
  std::string pgm, yaml;
  std::uint64_t occupied = 0, free = 0;  ///< cells
};

/// Follows rays through the heights in a robot's way: cells that they cross are free.
class FreeCells {
 public:
  FreeCells(double cell_m, const HeightRange& heights) : cell_m_(cell_m), heights_(heights) {}
  void add(const JudgedScan& scan, const RangeGate& range);
  bool has(std::int64_t x, std::int64_t y) const;
  /// Calls `visit` for the lowest and highest corners of squares that hold all of them.
  template <typename Visit>
  void for_each_square(Visit&& visit) const {
    for (const auto& [square, cells] : squares_) {
      visit(square.first * kSide, square.second * kSide);
      visit(square.first * kSide + kSide - 1, square.second * kSide + kSide - 1);
    }
  }

 private:
  static constexpr std::int64_t kSide = 64;
  using Square = std::pair<std::int64_t, std::int64_t>;
  /// Where a cell is kept.
  struct Place {
    Square square;
    std::size_t in_square;
  };
  static Place place_of(std::int64_t x, std::int64_t y);

  double cell_m_;
  HeightRange heights_;
  std::map<Square, std::bitset<kSide * kSide>> squares_;
};

/// Draws the points of a map: a cell with a point at these heights above the ground around is
/// occupied; one that a ray crossed, or that holds ground alone, is free. `image` names the .pgm in
/// the .yaml. Throws DataError naming it where the map has too many cells.
FloorPlan floor_plan(const StaticMap& map, const FreeCells& free, const HeightRange& heights,
                     const std::filesystem::path& image);

}  // namespace mosbench
