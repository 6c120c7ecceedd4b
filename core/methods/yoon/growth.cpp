#include "core/methods/yoon/growth.hpp"

#include <utility>

namespace mosbench::yoon {

std::vector<std::uint8_t> grow(std::vector<std::uint8_t> kept, const GrowthInput& input,
                               const Config& config) {
  std::vector<std::uint32_t> queue;
  std::vector<std::uint8_t> is_left(input.in_range.begin(), input.in_range.end());
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    if (kept[i] == 0) continue;
    queue.push_back(i);
    is_left[i] = 0;
  }
  if (queue.empty()) return kept;
  // Each point is looked at once: its residual does not depend on from where it was reached. In a
  // dense cluster nearly every point would else meet all others.
  PointCells left(input.points, is_left, config.growth_distance_m);
  const auto distance_m = static_cast<float>(config.growth_distance_m);
  const auto residual_m = static_cast<float>(config.growth_residual_m);
  std::vector<std::uint32_t> reached;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const Eigen::Vector3f& from = input.points[queue[next]];
    reached.clear();
    left.take_around(from, [&](std::uint32_t i) {
      const bool is_near = (input.points[i] - from).squaredNorm() <= distance_m * distance_m;
      if (is_near) reached.push_back(i);
      return is_near;
    });
    for (const std::uint32_t i : reached) {
      const Residual residual =
          residual_of(input.points[i], input.reference, input.reference_cells, config.planar_share);
      if (!(residual.distance_m > residual_m)) continue;
      kept[i] = 1;
      if (input.looks[i].finding != Look::Finding::kUnknown) queue.push_back(i);
    }
  }
  return kept;
}

}  // namespace mosbench::yoon
