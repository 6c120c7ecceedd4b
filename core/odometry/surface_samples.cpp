#include "core/odometry/surface_samples.hpp"

#include <Eigen/Eigenvalues>
#include <optional>

#include "core/odometry/thinning.hpp"

namespace mosbench::odometry {
namespace {

constexpr std::size_t kSamples = 512;
constexpr double kReachSpacings = 2.5;
constexpr std::size_t kFewestNeighbours = 9;
// Variance across a surface that is noise, and the ratio of extents below which points are a line.
constexpr double kPointNoise_m = 0.03, kLine = 0.1;
// Ratio of variances from which on a direction of larger extent holds a point as well: that of a
// thicket.
constexpr double kEdge = 1.0 / 3.0;

struct Spread {
  std::size_t points = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  Eigen::Matrix3d covariance() const {
    const auto n = static_cast<double>(points);
    const Eigen::Vector3d mean = sum / n;
    return squares / n - mean * mean.transpose();
  }
};

/// Directions in which the neighbourhood holds a point in place, 1 across a surface; nothing when
/// too few points or a line do not tell.
std::optional<Eigen::Matrix3d> hold(const PointGrid& grid, const Eigen::Vector3d& at_m,
                                    double reach_m) {
  Spread spread;
  grid.for_each_near(at_m, reach_m, [&](const Eigen::Vector3d& point_m) {
    const Eigen::Vector3d offset_m = point_m - at_m;
    if (!(offset_m.squaredNorm() < reach_m * reach_m)) return;
    ++spread.points;
    spread.sum += offset_m;
    spread.squares += offset_m * offset_m.transpose();
  });
  if (spread.points < kFewestNeighbours) return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(spread.covariance());
  const Eigen::Array3d variances = eigen.eigenvalues().array().max(0.0);
  if (!(variances[1] > kLine * kLine * variances[2])) return std::nullopt;
  const Eigen::Array3d noisy = variances + kPointNoise_m * kPointNoise_m;
  // Where two walls meet, points spread least along the one or the other, and most along the edge.
  const Eigen::Vector3d strength = ((noisy[0] / noisy - kEdge) / (1 - kEdge)).max(0.0);
  return eigen.eigenvectors() * strength.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

std::vector<SurfaceSample> surface_samples(std::span<const Eigen::Vector3d> points_m,
                                           double spacing_m) {
  std::vector<SurfaceSample> samples;
  PointGrid grid(spacing_m);
  insert_apart(points_m, spacing_m, grid);
  const std::size_t step = (points_m.size() + kSamples - 1) / kSamples;
  for (std::size_t i = 0; i < points_m.size(); i += step) {
    const auto held = hold(grid, points_m[i], kReachSpacings * spacing_m);
    if (held) samples.push_back({points_m[i], *held});
  }
  return samples;
}

}  // namespace mosbench::odometry
