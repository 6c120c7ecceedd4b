#include "datasets/doctor/pose_scatter.hpp"

#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {
namespace {

/// Noise per axis above which poses scatter: sound poses have 0.05 m at most.
constexpr double kLeastScatterM = 0.075;
/// White noise has 1.83; a sensor with other accelerations in each step sqrt(2) or less.
constexpr double kLeastWhiteness = 1.6;
/// No sensor is accelerated like this over half of its way.
constexpr double kLeastAccelerationMS2 = 12.0;
/// Medians of fewer differences say little.
constexpr std::size_t kFewestScattered = 20;

using Positions = std::vector<Eigen::Vector3d>;

Positions differences(const Positions& positions_m) {
  Positions between_m;
  for (std::size_t k = 1; k < positions_m.size(); ++k) {
    between_m.emplace_back(positions_m[k] - positions_m[k - 1]);
  }
  return between_m;
}

double median_length(const Positions& vectors) {
  std::vector<double> lengths;
  for (const Eigen::Vector3d& vector : vectors) lengths.push_back(vector.norm());
  return median(std::move(lengths));
}

}  // namespace

bool PoseScatter::is_found() const {
  return noise_m > kLeastScatterM && whiteness > kLeastWhiteness &&
         acceleration_m_s2 > kLeastAccelerationMS2;
}

PoseScatter scatter_of(const std::vector<Pose>& poses, double step_s) {
  Positions positions_m;
  for (const Pose& pose : poses) positions_m.emplace_back(pose.translation());
  const Positions second_m = differences(differences(positions_m));
  if (second_m.size() < kFewestScattered) return {};
  // Second differences of noise have 6 times its variance, and the median length of three normal
  // numbers is 1.538 of their deviation.
  constexpr double kLengthOfNoise = 1.538 * 2.449;
  const double rough_m = median_length(second_m);
  if (!(rough_m > 0.0)) return {};
  return {rough_m / kLengthOfNoise, median_length(differences(second_m)) / rough_m,
          rough_m / (step_s * step_s)};
}

}  // namespace mosbench
