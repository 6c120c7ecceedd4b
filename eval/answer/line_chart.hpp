#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/answer/picture.hpp"

namespace mosbench {

/// A line through points (x, y) that are finite; a ring around a single one.
struct Curve {
  std::string name;
  Colour colour;
  std::vector<std::array<double, 2>> points;
};

struct LineChart {
  std::string title, x_label, y_label;
  bool equal_scales = false;  ///< a metre is as long in x as in y
  std::vector<Curve> curves;
  /// Of both axes, instead of those of the points.
  std::optional<std::array<double, 2>> limits = std::nullopt;
};

/// Draws charts side by side, each `size_pixels` wide and high, with axes that show all points and
/// the names of the curves. A later curve lies over an earlier one.
Picture line_charts(std::span<const LineChart> charts, std::size_t size_pixels);

}  // namespace mosbench
