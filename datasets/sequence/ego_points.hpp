#pragma once

#include <cstddef>
#include <memory>
#include <mosbench/scan.hpp>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Where in the sensor's frame the vehicle itself, or what is mounted on it, is seen.
struct EgoPlaces {
  std::vector<bool> cells;  ///< of a grid around the sensor; empty where nothing is found
  double points_per_scan = 0.0;
  double farthest_m = 0.0;

  bool empty() const { return cells.empty(); }
  bool hold(const Point& point) const;
};

/// Returns "312 points per scan of the vehicle itself, within 1.9 m of the sensor".
std::string to_string(const EgoPlaces& ego);

/// Finds cells of 10 cm within 5 m that nearly all of up to 40 scans along the way hit, and whose
/// places on the map other scans look through once the vehicle is 4 m away: walls stay there. Finds
/// nothing where the poses move by less than 8 m. Reads each of these scans twice at most. Throws
/// DataError.
EgoPlaces find_ego(const Sequence& sequence);

/// Returns the sequence with these points as missing returns (0, 0, 0) with truth 0, so that one
/// label per stored point stays.
std::unique_ptr<Sequence> without_ego(std::unique_ptr<Sequence> inner);

}  // namespace mosbench
