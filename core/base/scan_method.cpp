#include "core/base/scan_method.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace mosbench {
namespace {

[[noreturn]] void throw_out_of_reach(std::size_t point, double reach_m) {
  std::ostringstream message;
  message << "point " << point << ": is out of reach of the method, expected a point within "
          << reach_m << " m of the sensor along each axis";
  throw std::range_error(message.str());
}

/// Returns how many points are not finite. Throws for a finite one out of reach.
std::size_t count_nonfinite(std::span<const Point> points, double reach_m) {
  std::size_t nonfinite = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
      ++nonfinite;
    } else if (std::abs(p.x) > reach_m || std::abs(p.y) > reach_m || std::abs(p.z) > reach_m) {
      throw_out_of_reach(i, reach_m);
    }
  }
  return nonfinite;
}

}  // namespace

void check_rigid(const Pose& pose) {
  // Wider than what readers accept, so that no pose of a file is refused here.
  constexpr double kTolerance = 2e-3;
  const Eigen::Matrix3d rotation = pose.linear();
  const double departure =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  // Negated, so that NaN fails as well.
  if (!pose.matrix().allFinite() || !(departure <= kTolerance) || !(rotation.determinant() > 0)) {
    throw std::range_error(
        "pose: is not a rigid motion, expected finite numbers and an orthonormal rotation");
  }
}

void check_origins(const RayOrigins& origins, std::size_t points) {
  if (origins.empty() && origins.positions_m.empty()) return;
  const auto has_place = [&](std::uint8_t index) { return index < origins.positions_m.size(); };
  const auto is_finite = [](const Eigen::Vector3d& place) { return place.allFinite(); };
  if (origins.of_point.size() != points || !std::ranges::all_of(origins.of_point, has_place) ||
      !std::ranges::all_of(origins.positions_m, is_finite)) {
    throw std::invalid_argument(
        "origins: do not fit the points, expected finite positions and one index of them per "
        "point");
  }
}

void expect_one_origin(const RayOrigins& origins) {
  if (origins.empty()) return;
  throw std::invalid_argument(
      "origins: are of several sensors, expected the points of one: this method looks from one "
      "place");
}

const RunContext& checked(const RunContext& context) {
  if (context.threads == 0) throw std::invalid_argument("threads: 0, expected at least 1");
  return context;
}

std::unique_ptr<PosedScan> SequentialMethod::see(std::span<const Point> points,
                                                 const Pose& map_from_sensor,
                                                 const RayOrigins& origins, ThreadPool&) {
  if (!takes_origins_) expect_one_origin(origins);
  auto scan = std::make_unique<PosedScan>();
  scan->nonfinite_points = count_nonfinite(points, reach_m_);
  scan->points.assign(points.begin(), points.end());
  scan->map_from_sensor = map_from_sensor;
  scan->origins = origins;
  return scan;
}

std::vector<LabelledScan> SequentialMethod::enter(PosedScan& scan) {
  LabelledScan result;
  result.scan_index = k();
  result.labels.assign(scan.points.size(), kStaticLabel);
  if (context().scores) result.scores.assign(scan.points.size(), 0);
  result.nonfinite_points = scan.nonfinite_points;
  return take(scan, std::move(result));
}

}  // namespace mosbench
