#include "core/odometry/surface_registration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "core/odometry/rigid_motion.hpp"

namespace mosbench::odometry {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kNearest_m = 2.0, kFarthest_m = 60.0;
constexpr double kCube_m = 0.5;
constexpr std::size_t kMostEntered = 40000, kMostRegistered = 4000;
/// Fewer points on surfaces tell no pose.
constexpr std::size_t kFewestMet = 100;
constexpr double kLeastShareMet = 0.3;
/// How far the true pose may be from the guess.
constexpr double kFarthestOff_m = 1.0, kFarthestOff_rad = 0.05;
/// How thick surfaces are taken to be, ever thinner.
constexpr std::array<double, 3> kThickness_m = {0.4, 0.1, 0.05};
constexpr int kMostSteps = 12;
/// Deviation of the guess, and how many neighbouring points err alike.
constexpr double kGuess_m = 0.05, kGuess_rad = 0.005, kErringAlike = 9.0;

template <typename Value>
std::vector<Value> picked(const std::vector<Value>& values, std::size_t most) {
  if (values.size() <= most) return values;
  std::vector<Value> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(values[i * values.size() / most]);
  return some;
}

std::vector<Eigen::Vector3d> first_of_cubes(std::span<const Eigen::Vector3d> points_m) {
  std::unordered_set<std::uint64_t> taken;
  std::vector<Eigen::Vector3d> firsts_m;
  for (const Eigen::Vector3d& p : points_m) {
    if (taken.insert(cube_key(p, kCube_m)).second) firsts_m.push_back(p);
  }
  return firsts_m;
}

/// What draws a scan to surfaces, and how strongly these hold it.
struct Pull {
  Matrix6 information = Matrix6::Zero();
  Offset6 gradient = Offset6::Zero();
  std::size_t met = 0;
};

void add_point(const Surface& surface, const Eigen::Vector3d& arm_m, const Eigen::Vector3d& off_m,
               double thickness_m, Pull& pull) {
  constexpr double kLeastWeight = 1e-3;
  const Eigen::Vector3d along_m = surface.directions.transpose() * off_m;
  const Eigen::Array3d hold = (surface.variance_m2.array() + thickness_m * thickness_m).inverse();
  const double weight = std::exp(-0.5 * (along_m.array().square() * hold).sum());
  if (weight < kLeastWeight) return;
  for (int i = 0; i < 3; ++i) {
    if (hold[i] == 0.0) continue;
    const Eigen::Vector3d direction = surface.directions.col(i);
    Offset6 by;
    by << direction, arm_m.cross(direction);
    pull.information.noalias() += weight * hold[i] * by * by.transpose();
    pull.gradient.noalias() += weight * hold[i] * along_m[i] * by;
  }
}

Pull pull_at(const SurfaceMap& map, const SurfacePoints& scan, const Pose& pose,
             double thickness_m) {
  Pull pull;
  for (const Eigen::Vector3d& p : scan.registered_m) {
    const Eigen::Vector3d q = moved(pose, p);
    const Surface* surface = map.at(q);
    if (surface == nullptr) continue;
    ++pull.met;
    add_point(*surface, q - pose.translation(), q - surface->mean_m, thickness_m, pull);
  }
  return pull;
}

void add_guess(const Offset6& off, Pull& pull) {
  Offset6 hold;
  hold << Eigen::Vector3d::Constant(kErringAlike / (kGuess_m * kGuess_m)),
      Eigen::Vector3d::Constant(kErringAlike / (kGuess_rad * kGuess_rad));
  pull.information.diagonal() += hold;
  pull.gradient += hold.cwiseProduct(off);
}

bool tell_a_pose(std::size_t met, const SurfacePoints& scan) {
  return met >= kFewestMet &&
         static_cast<double>(met) >= kLeastShareMet * static_cast<double>(scan.registered_m.size());
}

}  // namespace

Offset6 offset(const Pose& pose, const Pose& from) {
  Pose turn = Pose::Identity();
  turn.linear() = pose.linear() * from.linear().transpose();
  Offset6 off;
  off << pose.translation() - from.translation(), rotation_vector_of(turn);
  return off;
}

Pose moved_by(const Pose& pose, const Offset6& step) {
  Pose next = pose;
  next.linear() = rotation_about(step.tail<3>()) * pose.linear();
  next.translation() += step.head<3>();
  return next;
}

SurfacePoints::SurfacePoints(std::span<const Point> points) {
  std::vector<Eigen::Vector3d> in_range_m;
  in_range_m.reserve(points.size());
  for (const Point& point : points) {
    const Eigen::Vector3d p(point.x, point.y, point.z);
    const double range_sq_m2 = p.squaredNorm();
    if (range_sq_m2 > kNearest_m * kNearest_m && range_sq_m2 < kFarthest_m * kFarthest_m) {
      in_range_m.push_back(p);
    }
  }
  registered_m = picked(first_of_cubes(in_range_m), kMostRegistered);
  entered_m = picked(in_range_m, kMostEntered);
}

std::optional<Pose> registered(const SurfaceMap& map, const SurfacePoints& scan,
                               const Pose& guess) {
  constexpr double kStill_m = 1e-4, kStill_rad = 1e-5;
  Pose pose = guess;
  std::size_t met = 0;
  for (const double thickness_m : kThickness_m) {
    for (int step = 0; step < kMostSteps; ++step) {
      Pull pull = pull_at(map, scan, pose, thickness_m);
      met = pull.met;
      add_guess(offset(pose, guess), pull);
      const Offset6 change = -pull.information.ldlt().solve(pull.gradient);
      pose = moved_by(pose, change);
      const Offset6 off = offset(pose, guess);
      const bool is_near =
          off.head<3>().norm() < kFarthestOff_m && off.tail<3>().norm() < kFarthestOff_rad;
      if (!is_near) return std::nullopt;  // NaN, too
      if (change.head<3>().norm() < kStill_m && change.tail<3>().norm() < kStill_rad) break;
    }
  }
  return tell_a_pose(met, scan) ? std::optional(pose) : std::nullopt;
}

std::optional<double> fit_m(const SurfaceMap& map, const SurfacePoints& scan, const Pose& pose) {
  constexpr double kMost_m = 0.3;  // moving and hidden things do not decide
  double sum_m = 0.0;
  std::size_t met = 0;
  for (const Eigen::Vector3d& p : scan.registered_m) {
    const Eigen::Vector3d q = moved(pose, p);
    const Surface* surface = map.at(q);
    if (surface == nullptr || !surface->is_plane) continue;
    ++met;
    sum_m += std::min(std::abs(surface->directions.col(0).dot(q - surface->mean_m)), kMost_m);
  }
  if (met < kFewestMet) return std::nullopt;
  return sum_m / static_cast<double>(met);
}

}  // namespace mosbench::odometry
