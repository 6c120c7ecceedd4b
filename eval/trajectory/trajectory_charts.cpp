#include <fmt/format.h>

#include <array>
#include <string>

#include "eval/answer/picture.hpp"
#include "eval/trajectory/trajectory_scores.hpp"

namespace mosbench {
namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

/// The axes of the ground: x and z where the path hardly extends along y, as that of a camera.
std::array<Eigen::Index, 2> plane_of(const std::vector<Eigen::Vector3d>& path_m) {
  Eigen::Vector3d low = path_m.front(), high = low;
  for (const Eigen::Vector3d& position_m : path_m) {
    low = low.cwiseMin(position_m);
    high = high.cwiseMax(position_m);
  }
  const Eigen::Vector3d extent_m = high - low;
  return 3 * extent_m.y() < extent_m.z() ? std::array<Eigen::Index, 2>{0, 2}
                                         : std::array<Eigen::Index, 2>{0, 1};
}

Curve seen_from_above(std::string name, Colour colour, const std::vector<Eigen::Vector3d>& path_m,
                      const std::array<Eigen::Index, 2>& plane) {
  Curve curve{std::move(name), colour, {}};
  for (const Eigen::Vector3d& position_m : path_m) {
    curve.points.push_back({position_m[plane[0]], position_m[plane[1]]});
  }
  return curve;
}

Curve errors_over_way(std::string name, Colour colour, const TrajectoryScore& score) {
  Curve curve{std::move(name), colour, {}};
  double way_m = 0;
  for (std::size_t i = 0; i < score.poses; ++i) {
    if (i > 0) way_m += (score.truth_m[i] - score.truth_m[i - 1]).norm();
    curve.points.push_back({way_m, score.absolute.translation_m[i]});
  }
  return curve;
}

}  // namespace

std::vector<LineChart> trajectory_charts(std::span<const TrajectoryScore* const> estimates,
                                         PathAlignment alignment) {
  const Palette colours = palette(false);
  const std::vector<Eigen::Vector3d>& truth_m = estimates.front()->truth_m;
  const auto plane = plane_of(truth_m);
  const auto axis = [&](std::size_t i) {
    return fmt::format("{} [m]", kAxes[static_cast<std::size_t>(plane[i])]);
  };
  LineChart above{
      fmt::format("{} from above, alignment {}", estimates.front()->name, to_string(alignment)),
      axis(0),
      axis(1),
      true,
      {}};
  LineChart errors{"distance to the truth", "way [m]", "[m]", false, {}};
  above.curves.push_back(seen_from_above("truth", colours.text, truth_m, plane));
  // As right and false points are: far apart with any colour vision.
  for (std::size_t e = 0; e < estimates.size(); ++e) {
    const std::string name = estimates.size() == 1 ? "estimate" : e == 0 ? "first" : "second";
    above.curves.push_back(
        seen_from_above(name, colours.outcomes[e].colour, estimates[e]->estimate_m, plane));
    errors.curves.push_back(errors_over_way(name, colours.outcomes[e].colour, *estimates[e]));
  }
  return {above, errors};
}

}  // namespace mosbench
