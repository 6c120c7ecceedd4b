#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "datasets/doctor/pose_evidence.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// Returns the pose of a quaternion that was stored w x y z and read as x y z w.
Pose with_w_first(const Pose& pose) {
  const Eigen::Quaterniond read(pose.linear());
  Pose result = pose;
  result.linear() = Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).toRotationMatrix();
  return result;
}

/// Returns the pose whose angle was given in radians and read as degrees.
Pose with_radians(const Pose& pose) {
  constexpr double kDegreesOfRadian = 180.0 / M_PI;
  const Eigen::AngleAxisd read(pose.linear());
  Pose result = pose;
  result.linear() =
      Eigen::AngleAxisd(kDegreesOfRadian * read.angle(), read.axis()).toRotationMatrix();
  return result;
}

template <typename Change>
PoseConvention changed(std::string name, std::string advice, const std::vector<Pose>& poses,
                       Change&& change) {
  PoseConvention convention{std::move(name), std::move(advice), {}};
  for (const Pose& pose : poses) convention.map_from_sensor.push_back(change(pose));
  return convention;
}

void add_frames(const std::vector<Pose>& given, const std::optional<Pose>& camera_from_lidar,
                bool applied, std::vector<PoseConvention>& conventions) {
  Pose looks_ahead = Pose::Identity();
  looks_ahead.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Pose tr = camera_from_lidar.value_or(looks_ahead);
  const auto stored = [&](const Pose& pose) { return applied ? tr * pose * tr.inverse() : pose; };
  const auto of_camera = [&](const Pose& pose) { return lidar_pose(pose, tr); };
  if (applied) {
    conventions.push_back(changed("the lidar's, Tr not to be applied",
                                  "run with " + option("pose_frame", "lidar"), given, stored));
    conventions.back().remedy.pose_frame = PoseFrame::kLidar;
  } else if (camera_from_lidar) {
    conventions.push_back(changed("the camera's, Tr to be applied",
                                  "run with " + option("pose_frame", "camera"), given, of_camera));
    conventions.back().remedy.pose_frame = PoseFrame::kCamera;
  } else {
    conventions.push_back(changed("the camera's, Tr is missing",
                                  "put the data set's calib.txt with its Tr next to the poses",
                                  given, of_camera));
  }
  conventions.push_back(changed("sensor_from_map (inverse)",
                                "run with " + option("pose_direction", "sensor-from-map"), given,
                                [](const Pose& pose) { return pose.inverse(); }));
  conventions.back().remedy.pose_direction = PoseDirection::kSensorFromMap;
  conventions.push_back(changed("with transposed rotations", "write each row's rotation row by row",
                                given, [&](const Pose& read) {
                                  Pose pose = stored(read);
                                  pose.linear().transposeInPlace();
                                  return applied ? lidar_pose(pose, tr) : pose;
                                }));
}

using Axes = std::array<double, 9>;
constexpr Axes kSwappedXy = {0, 1, 0, 1, 0, 0, 0, 0, 1}, kOtherY = {1, 0, 0, 0, -1, 0, 0, 0, 1},
               kOtherZ = {1, 0, 0, 0, 1, 0, 0, 0, -1}, kOfCamera = {0, 0, 1, -1, 0, 0, 0, -1, 0};

/// Another sign or order of axes, of the translations relative to the first pose or of the points.
struct OtherAxes {
  const char *name, *advice;
  const Axes& axes;
  bool of_points = true;
};

constexpr const char* kTurnSign = "turn the sign of the translations";
constexpr OtherAxes kOtherAxes[] = {
    {"with x and y of their translations swapped", "exchange the two translations", kSwappedXy,
     false},
    {"with the other sign of y of their translations", kTurnSign, kOtherY, false},
    {"with the other sign of z of their translations", kTurnSign, kOtherZ, false},
    {"with x and y of the points swapped", "export the scans again with x before y", kSwappedXy},
    {"with the points mirrored", "export the scans again without a turned sign", kOtherY},
    {"with the points turned from upside down", "export the scans again with z upwards", kOtherZ},
    {"with the points turned from a camera's axes",
     "export the scans again with x forward, y left and z up", kOfCamera}};

PoseConvention with_axes(const OtherAxes& other, const std::vector<Pose>& given) {
  const Eigen::Matrix3d axes =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(other.axes.data());
  if (other.of_points) return {other.name, other.advice, given, axes};
  return changed(other.name, other.advice, given, [&](Pose pose) {
    pose.translation() = (axes * pose.translation()).eval();
    return pose;
  });
}

// --- Corrections that are fitted.

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

Reading Remedy::applied_to(Reading reading) const {
  if (pose_frame) reading.pose_frame = *pose_frame;
  if (pose_direction) reading.pose_direction = pose_direction;
  reading.pose_offset_s = pose_offset_s.value_or(reading.pose_offset_s);
  return reading;
}

std::optional<Pose> PoseConvention::motion(const ScanPair& pair) const {
  if (pair.earlier < first && pair.later >= first) return std::nullopt;
  const auto rows = static_cast<std::ptrdiff_t>(map_from_sensor.size());
  const int added = pair.later < first ? rows_before : rows_later;
  const std::ptrdiff_t earlier = static_cast<std::ptrdiff_t>(pair.earlier) + added;
  const std::ptrdiff_t later = static_cast<std::ptrdiff_t>(pair.later) + added;
  if (earlier < 0 || later >= rows) return std::nullopt;
  Pose between = relative(map_from_sensor,
                          {static_cast<std::size_t>(earlier), static_cast<std::size_t>(later)});
  between.linear() = axes.inverse() * between.linear() * axes;
  between.translation() = axes.inverse() * between.translation();
  return between;
}

PoseConvention shifted(const std::vector<Pose>& given, int rows_later) {
  const int rows = std::abs(rows_later);
  const std::string count = rows == 1 ? "one" : std::to_string(rows);
  const std::string those = rows == 1 ? "row" : fmt::format("{} rows", rows);
  PoseConvention convention{
      fmt::format("{} {} {}", count, rows == 1 ? "row" : "rows",
                  rows_later > 0 ? "later" : "earlier"),
      rows_later > 0 ? fmt::format("remove the first {} and add {} at the end", those, count)
                     : fmt::format("remove the last {} and add {} in front", those, count),
      given};
  convention.rows_later = rows_later;
  return convention;
}

std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied) {
  std::vector<PoseConvention> conventions;
  add_frames(given, camera_from_lidar, applied, conventions);
  conventions.push_back(changed("with w as the first number of each quaternion",
                                "write the quaternions as x y z w", given, with_w_first));
  conventions.push_back(changed("with rotations in radians that were taken for degrees",
                                "convert the angles to degrees before making poses", given,
                                with_radians));
  conventions.push_back(
      {"in reverse order", "reverse the order of the rows", {given.rbegin(), given.rend()}});
  for (const OtherAxes& other : kOtherAxes) conventions.push_back(with_axes(other, given));
  conventions.push_back(changed("of points that are in the map's frame already",
                                "export the scans again in the sensor's frame", given,
                                [](const Pose&) { return Pose(Pose::Identity()); }));
  conventions.back().stands = true;
  for (int rows = 1; rows <= kMostRowsShifted; ++rows) {
    conventions.push_back(shifted(given, rows));
    conventions.push_back(shifted(given, -rows));
  }
  return conventions;
}

std::vector<PoseConvention> fitted_corrections(const std::vector<Pose>& given,
                                               const MeasuredMotions& measured) {
  const PoseConvention as_given{"", "", given};
  std::vector<PoseConvention> corrections;
  double scale = 1.0;
  PoseConvention larger = fitted(
      as_given, measured, [&](const auto& pairs) { return scale = scale_of(pairs); },
      [&](PoseConvention& convention, double by) {
        convention.map_from_sensor = given;
        for (Pose& pose : convention.map_from_sensor) pose.translation() *= by;
      });
  if (scale > 0.0 && std::abs(std::log(scale)) > kLeastScaleChange) {
    larger.name = fmt::format("{:.3g} times as long", scale);
    larger.advice = fmt::format("multiply their translations by {:.3g} (or the points by {:.3g})",
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
    turned.advice = "correct the sensor's rotation in its calibration";
    corrections.push_back(std::move(turned));
  }
  Eigen::Vector3d lever_m = Eigen::Vector3d::Zero();
  PoseConvention levered = fitted(
      as_given, measured, [&](const auto& pairs) { return lever_m = lever_of(pairs); },
      [&](PoseConvention& convention, const Eigen::Vector3d& by_m) {
        convention.map_from_sensor = given;
        for (Pose& pose : convention.map_from_sensor) pose.translate(by_m);
      });
  if (lever_m.norm() > kLeastLeverM) {
    levered.name = fmt::format("of a place {:.1f}, {:.1f}, {:.1f} m (x, y, z) from the sensor",
                               -lever_m.x(), -lever_m.y(), -lever_m.z());
    levered.advice = "correct the sensor's position (lever arm) in its calibration";
    corrections.push_back(std::move(levered));
  }
  return corrections;
}

}  // namespace mosbench
