#include "datasets/doctor/scan_overlap.hpp"

#include <utility>

#include "datasets/text/quantile.hpp"

namespace mosbench {

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair) {
  return poses[pair.earlier].inverse() * poses[pair.later];
}

double difference_m(const Pose& a, const Pose& b) {
  constexpr double kRangeM = 10.0;
  const Pose between = a.inverse() * b;
  return between.translation().norm() + kRangeM * Eigen::AngleAxisd(between.linear()).angle();
}

double median(std::vector<double> values) {
  return quantile(std::move(values), 0.5, QuantileRule::kUpper);
}

const ScanOverlap::Scan& ScanOverlap::at(std::size_t scan_index) {
  constexpr std::size_t kSurfacePoints = 40000, kMovedPoints = 1500;
  auto& scan = scans_[scan_index];
  if (!scan) {
    const std::vector<Eigen::Vector3d> near_m = near_points(sequence_.read(scan_index).points);
    scan = std::make_unique<Scan>(
        Scan{picked(near_m, kMovedPoints), SurfaceCells(picked(near_m, kSurfacePoints))});
  }
  return *scan;
}

}  // namespace mosbench
