#include "datasets/sequence/azimuth_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mosbench {
namespace {

constexpr std::int64_t kUsualTurn_ns = 100'000'000, kLongestTurn_ns = 1'000'000'000;
// All points of one step are moved by one pose. At 30 m/s a step is 0.3 mm long.
constexpr double kSteps = 10'000;

std::int64_t median_interval_ns(const std::vector<ScanEntry>& scans) {
  std::vector<std::int64_t> intervals_ns;
  for (std::size_t k = 1; k < scans.size(); ++k) {
    if (!scans[k].stamp_ns || !scans[k - 1].stamp_ns) return kUsualTurn_ns;
    intervals_ns.push_back(*scans[k].stamp_ns - *scans[k - 1].stamp_ns);
  }
  if (intervals_ns.empty()) return kUsualTurn_ns;
  const auto middle = intervals_ns.begin() + static_cast<std::ptrdiff_t>(intervals_ns.size() / 2);
  std::ranges::nth_element(intervals_ns, middle);
  return *middle > 0 && *middle <= kLongestTurn_ns ? *middle : kUsualTurn_ns;
}

}  // namespace

std::vector<std::int64_t> azimuth_times_ns(std::span<const Point> points, std::int64_t turn_ns) {
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(points.size());
  for (const Point& point : points) {
    const double turns = -std::atan2(static_cast<double>(point.y), static_cast<double>(point.x)) /
                         (2 * std::numbers::pi);
    const double step = std::isfinite(turns) ? std::round(kSteps * turns) : 0;
    times_ns.push_back(std::llround(step / kSteps * static_cast<double>(turn_ns)));
  }
  return times_ns;
}

AzimuthTimes::AzimuthTimes(std::unique_ptr<Sequence> inner)
    : SequenceAround(std::move(inner)), turn_ns_(median_interval_ns(recording().scans)) {
  const std::string how =
      fmt::format("by azimuth, a turn in {:g} s", static_cast<double>(turn_ns_) * 1e-9);
  mutable_recording().reading.point_times = how;
  mutable_recording().remarks.push_back("times of points " + how);
}

void AzimuthTimes::read(std::size_t scan_index, Frame& frame) const {
  SequenceAround::read(scan_index, frame);
  frame.point_times_ns = azimuth_times_ns(frame.points, turn_ns_);
}

}  // namespace mosbench
