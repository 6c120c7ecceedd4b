#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <optional>
#include <vector>

namespace mosbench {

/// Rows first ... last of a pose file, counted from 0.
struct RowRange {
  std::size_t first = 0, last = 0;
  std::size_t rows() const { return last - first + 1; }
};

/// Returns runs of two or more rows with the same numbers.
std::vector<RowRange> equal_rows(const std::vector<Pose>& poses);

/// Returns the rows after the steps that stand out most from the steps around them, longest first.
std::vector<std::size_t> odd_steps(const std::vector<Pose>& poses, std::size_t most);

bool all_rotations_equal(const std::vector<Pose>& poses);

/// Returns the axis (0 to 2) along which no pose moves by a micrometre, though others do by metres
/// and the poses roll or pitch, unlike those of a robot that knows a plane only.
std::optional<int> constant_axis(const std::vector<Pose>& poses);

}  // namespace mosbench
