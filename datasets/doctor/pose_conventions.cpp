#include "datasets/doctor/pose_conventions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/formats/calib_file.hpp"

namespace mosbench {
namespace {

template <typename Change>
PoseConvention changed(std::string name, std::string remedy, const std::vector<Pose>& poses,
                       Change&& change) {
  PoseConvention convention{std::move(name), std::move(remedy), {}};
  for (const Pose& pose : poses) convention.map_from_sensor.push_back(change(pose));
  return convention;
}

PoseConvention with_axes(std::string name, std::string remedy, const std::vector<Pose>& poses,
                         const Eigen::Matrix3d& axes) {
  return {std::move(name), std::move(remedy), poses, axes};
}

Eigen::Matrix3d swapped_xy() {
  Eigen::Matrix3d swap;
  swap << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  return swap;
}

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

Eigen::Matrix3d axes_of_camera() {
  Eigen::Matrix3d lidar_from_camera;
  lidar_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return lidar_from_camera;
}

/// Returns the poses with their translations, relative to the first one, changed.
PoseConvention with_translations(std::string name, std::string remedy,
                                 const std::vector<Pose>& poses, const Eigen::Matrix3d& change) {
  return changed(std::move(name), std::move(remedy), poses, [&](const Pose& pose) {
    Pose result = pose;
    result.translation() = change * pose.translation();
    return result;
  });
}

void add_frames(const std::vector<Pose>& given, const std::optional<Pose>& camera_from_lidar,
                bool applied, std::vector<PoseConvention>& conventions) {
  Pose looks_ahead = Pose::Identity();
  looks_ahead.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Pose tr = camera_from_lidar.value_or(looks_ahead);
  const auto stored = [&](const Pose& pose) { return applied ? tr * pose * tr.inverse() : pose; };
  if (applied) {
    conventions.push_back(
        changed("the lidar's, Tr not to be applied", "run with --pose-frame lidar", given, stored));
  } else {
    conventions.push_back(changed(
        camera_from_lidar ? "the camera's, Tr to be applied" : "the camera's, Tr is missing",
        camera_from_lidar ? "run with --pose-frame camera"
                          : "put the data set's calib.txt with its Tr next to the poses",
        given, [&](const Pose& pose) { return lidar_pose(pose, tr); }));
  }
  conventions.push_back(changed("sensor_from_map (inverse)",
                                "run with --pose-direction sensor-from-map", given,
                                [](const Pose& pose) { return pose.inverse(); }));
  conventions.push_back(changed("with transposed rotations", "write each row's rotation row by row",
                                given, [&](const Pose& read) {
                                  Pose pose = stored(read);
                                  pose.linear().transposeInPlace();
                                  return applied ? lidar_pose(pose, tr) : pose;
                                }));
}

}  // namespace

std::optional<Pose> PoseConvention::motion(const ScanPair& pair) const {
  const auto rows = static_cast<std::ptrdiff_t>(map_from_sensor.size());
  const std::ptrdiff_t earlier = static_cast<std::ptrdiff_t>(pair.earlier) + rows_later;
  const std::ptrdiff_t later = static_cast<std::ptrdiff_t>(pair.later) + rows_later;
  if (earlier < 0 || later >= rows) return std::nullopt;
  Pose between = relative(map_from_sensor,
                          {static_cast<std::size_t>(earlier), static_cast<std::size_t>(later)});
  between.linear() = axes.inverse() * between.linear() * axes;
  between.translation() = axes.inverse() * between.translation();
  return between;
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
  conventions.push_back(with_translations("with x and y of their translations swapped",
                                          "exchange the two translations", given, swapped_xy()));
  conventions.push_back(with_translations("with the other sign of y of their translations",
                                          "turn the sign of the translations", given,
                                          Eigen::Vector3d(1, -1, 1).asDiagonal()));
  conventions.push_back(with_translations("with the other sign of z of their translations",
                                          "turn the sign of the translations", given,
                                          Eigen::Vector3d(1, 1, -1).asDiagonal()));
  conventions.push_back(with_axes("with x and y of the points swapped",
                                  "export the scans again with x before y", given, swapped_xy()));
  conventions.push_back(with_axes("with the points mirrored",
                                  "export the scans again without a turned sign", given,
                                  Eigen::Vector3d(1, -1, 1).asDiagonal()));
  conventions.push_back(with_axes("with the points turned from upside down",
                                  "export the scans again with z upwards", given,
                                  Eigen::Vector3d(1, 1, -1).asDiagonal()));
  conventions.push_back(with_axes("with the points turned from a camera's axes",
                                  "export the scans again with x forward, y left and z up", given,
                                  axes_of_camera()));
  conventions.push_back(changed("of points that are in the map's frame already",
                                "export the scans again in the sensor's frame", given,
                                [](const Pose&) { return Pose(Pose::Identity()); }));
  conventions.back().stands = true;
  return conventions;
}

std::vector<PoseConvention> shifted_rows(const std::vector<Pose>& given) {
  std::vector<PoseConvention> shifted;
  for (int rows = 1; rows <= kMostRowsShifted; ++rows) {
    const std::string count = rows == 1 ? "one row" : fmt::format("{} rows", rows);
    const std::string those = rows == 1 ? "row" : fmt::format("{} rows", rows);
    shifted.push_back({count + " later",
                       fmt::format("remove the first {} and add {} at the end", those,
                                   rows == 1 ? "one" : std::to_string(rows)),
                       given});
    shifted.back().rows_later = rows;
    shifted.push_back({count + " earlier",
                       fmt::format("remove the last {} and add {} in front", those,
                                   rows == 1 ? "one" : std::to_string(rows)),
                       given});
    shifted.back().rows_later = -rows;
  }
  return shifted;
}

}  // namespace mosbench
