#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "datasets/doctor/pose_conventions.hpp"

namespace mosbench {
namespace {

/// Smaller corrections change no result by much, and may come from the registration.
constexpr double kLeastScaleChange = 0.03;
/// Poses that are so much too long claim a motion that may only have been measured too short.
constexpr double kShrinks = 0.5;
constexpr double kLeastTurnRad = 1.5 * M_PI / 180.0;
constexpr double kLeastLeverM = 0.3;
constexpr int kRounds = 8;
/// A radian counts like so many metres.
constexpr double kMOfRad = 10.0;

/// Motions that a correction is fitted to, with what they count: those that it does not explain
/// count little.
struct Weighed {
  const MeasuredMotion* measured;
  Pose given;
  double weight;
};

std::vector<Weighed> weighed(const PoseConvention& current, const PoseConvention& given,
                             const MeasuredMotions& measured) {
  std::vector<Weighed> all;
  for (const MeasuredMotion& motion : measured.pairs) {
    const double error_m2 = motion.covariance.topLeftCorner<3, 3>().trace();
    const double misfit = motion.unsound(*current.motion(motion.pair)).both();
    all.push_back(
        {&motion, *given.motion(motion.pair), 1.0 / ((1.0 + misfit) * (1e-3 + error_m2))});
  }
  return all;
}

double scale_of(const std::vector<Weighed>& pairs) {
  double along = 0.0, whole = 0.0;
  for (const Weighed& pair : pairs) {
    const Eigen::Vector3d given_m = pair.given.translation();
    // A claimed step of a kilometre must not outweigh all others.
    const double weight = pair.weight / (1e-4 + given_m.squaredNorm());
    along += weight * given_m.dot(pair.measured->motion.translation());
    whole += weight * given_m.squaredNorm();
  }
  return whole > 0.0 ? along / whole : 1.0;
}

/// Returns the angle about the axis by which given motions are turned to measured ones.
double turn_of(const std::vector<Weighed>& pairs, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  double across = 0.0, along = 0.0;
  const auto add = [&](double weight, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    across += weight * (a[u] * b[v] - a[v] * b[u]);
    along += weight * (a[u] * b[u] + a[v] * b[v]);
  };
  for (const Weighed& pair : pairs) {
    const Eigen::AngleAxisd given(pair.given.linear()), motion(pair.measured->motion.linear());
    add(pair.weight, pair.given.translation(), pair.measured->motion.translation());
    add(pair.weight * kMOfRad * kMOfRad, given.angle() * given.axis(),
        motion.angle() * motion.axis());
  }
  return std::atan2(across, along);
}

/// Returns l of M = D * (R_D l - l): where the sensor is in the frame of the given poses.
Eigen::Vector3d lever_of(const std::vector<Weighed>& pairs) {
  Eigen::Matrix3d squares = 1e-3 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d sides = Eigen::Vector3d::Zero();
  for (const Weighed& pair : pairs) {
    const Eigen::Matrix3d turn = pair.given.linear() - Eigen::Matrix3d::Identity();
    squares += pair.weight * turn.transpose() * turn;
    sides += pair.weight * turn.transpose() *
             (pair.measured->motion.translation() - pair.given.translation());
  }
  return squares.ldlt().solve(sides);
}

std::vector<Pose> moved(std::vector<Pose> poses, const Eigen::Vector3d& lever_m) {
  for (Pose& pose : poses) pose.translate(lever_m);
  return poses;
}

std::vector<Pose> scaled(std::vector<Pose> poses, double factor) {
  for (Pose& pose : poses) pose.translation() *= factor;
  return poses;
}

template <typename Fit, typename Apply>
PoseConvention fitted(const PoseConvention& given, const MeasuredMotions& measured, Fit&& fit,
                      Apply&& apply) {
  PoseConvention current = given;
  for (int round = 0; round < kRounds; ++round) {
    apply(current, fit(weighed(current, given, measured)));
  }
  return current;
}

}  // namespace

std::vector<PoseConvention> fitted_corrections(const std::vector<Pose>& given,
                                               const MeasuredMotions& measured) {
  const PoseConvention as_given{"", "", given};
  std::vector<PoseConvention> corrections;
  double scale = 1.0;
  PoseConvention larger = fitted(
      as_given, measured, [&](const auto& pairs) { return scale = scale_of(pairs); },
      [&](PoseConvention& convention, double by) {
        convention.map_from_sensor = scaled(given, by);
      });
  if (scale > 0.0 && std::abs(std::log(scale)) > kLeastScaleChange) {
    larger.name = fmt::format("{:.3g} times as long", scale);
    larger.remedy = fmt::format("multiply their translations by {:.3g} (or the points by {:.3g})",
                                scale, 1.0 / scale);
    larger.stands = scale < kShrinks;
    corrections.push_back(std::move(larger));
  }
  for (int axis = 0; axis < 3; ++axis) {
    double turn_rad = 0.0;
    PoseConvention turned = fitted(
        as_given, measured, [&](const auto& pairs) { return turn_rad = turn_of(pairs, axis); },
        [&](PoseConvention& convention, double by) {
          convention.axes = Eigen::AngleAxisd(-by, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
        });
    if (std::abs(turn_rad) < kLeastTurnRad) continue;
    constexpr const char* kTurns[] = {"roll", "pitch", "yaw"};
    turned.name = fmt::format("of a sensor mounted with {:.1f} degrees {}", turn_rad * 180.0 / M_PI,
                              kTurns[axis]);
    turned.remedy = "correct the sensor's rotation in its calibration";
    corrections.push_back(std::move(turned));
  }
  Eigen::Vector3d lever_m = Eigen::Vector3d::Zero();
  PoseConvention levered = fitted(
      as_given, measured, [&](const auto& pairs) { return lever_m = lever_of(pairs); },
      [&](PoseConvention& convention, const Eigen::Vector3d& by_m) {
        convention.map_from_sensor = moved(given, by_m);
      });
  if (lever_m.norm() > kLeastLeverM) {
    levered.name = fmt::format("of a place {:.1f}, {:.1f}, {:.1f} m (x, y, z) from the sensor",
                               -lever_m.x(), -lever_m.y(), -lever_m.z());
    levered.remedy = "correct the sensor's position (lever arm) in its calibration";
    corrections.push_back(std::move(levered));
  }
  return corrections;
}

}  // namespace mosbench
