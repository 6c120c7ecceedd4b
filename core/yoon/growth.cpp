#include "core/yoon/growth.hpp"

#include <utility>

namespace mosbench::yoon {

std::vector<std::uint8_t> grow(std::vector<std::uint8_t> kept, const GrowthInput& input,
                               const Config& config) {
  std::vector<std::uint32_t> queue;
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    if (kept[i] != 0) queue.push_back(i);
  }
  if (queue.empty()) return kept;
  const PointCells cells(input.points, input.in_range, config.growth_distance_m);
  const auto distance_m = static_cast<float>(config.growth_distance_m);
  const auto residual_m = static_cast<float>(config.growth_residual_m);
  // Each point is looked at once: its residual does not depend on from where it was reached.
  std::vector<std::uint8_t> seen = kept;
  std::vector<std::uint32_t> reached;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const Eigen::Vector3f& from = input.points[queue[next]];
    reached.clear();
    cells.for_each_around(from, [&](std::uint32_t i) {
      if (seen[i] != 0 || !((input.points[i] - from).squaredNorm() <= distance_m * distance_m)) {
        return;
      }
      seen[i] = 1;
      reached.push_back(i);
    });
    for (const std::uint32_t i : reached) {
      const Residual residual =
          residual_of(input.points[i], input.reference, input.reference_cells, config.planar_share);
      if (!(residual.distance_m > residual_m)) continue;
      kept[i] = 1;
      if (input.findings[i] != underwood::Look::Finding::kUnknown) queue.push_back(i);
    }
  }
  return kept;
}

}  // namespace mosbench::yoon
