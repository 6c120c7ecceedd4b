#include "core/base/sequential_method.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "core/base/push_order.hpp"

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

SequentialMethod::SequentialMethod(const RunContext& context, double reach_m)
    : context_(checked(context)),
      reach_m_(reach_m),
      order_(context.scan_count),
      pool_(context.threads) {}

std::unique_ptr<Observed> SequentialMethod::observe(std::span<const Point> points,
                                                    const Pose& map_from_sensor) {
  check_rigid(map_from_sensor);
  auto scan = std::make_unique<PosedScan>();
  scan->nonfinite_points = count_nonfinite(points, reach_m_);
  scan->points.assign(points.begin(), points.end());
  scan->map_from_sensor = map_from_sensor;
  order_.number(*scan);
  return scan;
}

std::vector<LabelledScan> SequentialMethod::push(std::unique_ptr<Observed> observed) {
  LabelledScan result;
  result.scan_index = order_.pushed();
  auto& scan = order_.take<PosedScan>(observed.get());
  result.labels.assign(scan.points.size(), kStaticLabel);
  if (context_.scores) result.scores.assign(scan.points.size(), 0);
  result.nonfinite_points = scan.nonfinite_points;
  return take(scan, std::move(result));
}

std::vector<LabelledScan> SequentialMethod::finish() {
  order_.finish();
  return release();
}

}  // namespace mosbench
