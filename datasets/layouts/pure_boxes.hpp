#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

namespace mosbench {

/// A box along the axes of the points' frame.
struct AxisBox {
  Eigen::Vector3d low_m, high_m;
};

/// Returns boxes that hold the points at the places `inside` and none of those at `outside`,
/// however they lie, unless two of both lie within some hundredths of a millimetre. Few boxes where
/// points of one kind keep together.
std::vector<AxisBox> pure_boxes(std::span<const Point> points, std::vector<std::uint32_t> inside,
                                std::vector<std::uint32_t> outside);

}  // namespace mosbench
