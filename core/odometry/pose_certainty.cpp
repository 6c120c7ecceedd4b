#include "core/odometry/pose_certainty.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>

#include "core/odometry/point_grid.hpp"

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

constexpr double kLeastStrength = 1e-9;
// Surfaces this far from those of the map are others.
constexpr double kOther_m = 0.3;
// Added to what is known of a direction, so that next to nothing asks for no correction.
constexpr double kDamping = 0.01;
// Surfaces are known no better than this, however small their residuals are.
constexpr double kNoise_m = 0.02;

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Eigen3d = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

Eigen::Matrix<double, 3, 6> point_motion(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << 0, p.z(), -p.y(), 1, 0, 0, -p.z(), 0, p.x(), 0, 1, 0, p.y(), -p.x(), 0, 0, 0, 1;
  return jacobian;
}

/// Sums over samples of J' hold J, J' hold offset and offset' hold offset.
struct ResidualSums {
  Matrix6d information = Matrix6d::Zero();
  Motion6 pull = Motion6::Zero();
  double squares_m2 = 0, held = 0;  // held directions

  void add(const SurfaceSample& sample, const Eigen::Vector3d& offset_m) {
    const Eigen::Matrix<double, 3, 6> jacobian = point_motion(sample.point_m);
    information += jacobian.transpose() * sample.hold * jacobian;
    pull += jacobian.transpose() * sample.hold * offset_m;
    squares_m2 += offset_m.dot(sample.hold * offset_m);
    held += sample.hold.trace();
  }
};

/// The information about one half of the six numbers when the other half is free.
Eigen::Matrix3d marginal(const Matrix6d& information, Eigen::Index half, Eigen::Index other) {
  const Eigen::Matrix3d cross = information.block<3, 3>(half, other);
  const Eigen::Matrix3d rest =
      information.block<3, 3>(other, other) + kLeastStrength * Eigen::Matrix3d::Identity();
  return information.block<3, 3>(half, half) - cross * rest.inverse() * cross.transpose();
}

void find_weakest(const Matrix6d& information, Certainty& certainty) {
  const Eigen3d turns(marginal(information, 0, 3)), shifts(marginal(information, 3, 0));
  const double turn = turns.eigenvalues()[0], shift = shifts.eigenvalues()[0];
  certainty.weakest_shift = shifts.eigenvectors().col(0);
  certainty.weakest = std::max(std::min(turn, shift), 0.0);
  if (turn < shift) {
    certainty.weakest_direction.head<3>() = turns.eigenvectors().col(0);
  } else {
    certainty.weakest_direction.tail<3>() = shifts.eigenvectors().col(0);
  }
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

Certainty certainty_of(std::span<const SurfaceSample> samples,
                       std::span<const std::optional<Eigen::Vector3d>> offsets_m) {
  Certainty certainty;
  ResidualSums all, met;
  double range_m = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    range_m += samples[i].point_m.norm();
    all.add(samples[i], Eigen::Vector3d::Zero());
    if (offsets_m[i] && (samples[i].hold * *offsets_m[i]).norm() < kOther_m) {
      met.add(samples[i], *offsets_m[i]);
    }
  }
  const auto count = static_cast<double>(std::max<std::size_t>(samples.size(), 1));
  find_weakest(all.information / count, certainty);

  // Rotations by how far they move a point at the mean range, so that numbers are of one size.
  Matrix6d to_radians = Matrix6d::Identity();
  to_radians.diagonal().head<3>() /= std::max(range_m / count, kNoise_m);
  const Matrix6d scaled = to_radians * (met.information / count) * to_radians;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  const Eigen::Array<double, 6, 1> strengths = eigen.eigenvalues().array().max(kLeastStrength);
  certainty.condition = strengths[5] / strengths[0];
  const auto inverse = [&](const Eigen::Array<double, 6, 1>& of) -> Matrix6d {
    return to_radians * eigen.eigenvectors() * of.inverse().matrix().asDiagonal() *
           eigen.eigenvectors().transpose() * to_radians;
  };
  const double points = std::max(met.held, 1.0);
  const double variance_m2 = met.squares_m2 / points + kNoise_m * kNoise_m;
  const Motion6 correction = -inverse(strengths + kDamping) * (met.pull / count);
  certainty.covariance =
      variance_m2 / points * inverse(strengths) + correction * correction.transpose();
  return certainty;
}

}  // namespace mosbench::odometry
