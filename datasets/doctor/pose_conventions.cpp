#include "datasets/doctor/pose_conventions.hpp"

#include <algorithm>

#include "datasets/files/calib_file.hpp"

namespace mosbench {
namespace {

Pose swapped_xy(const Pose& pose) {
  Eigen::Matrix4d swap = Eigen::Matrix4d::Zero();
  swap(0, 1) = swap(1, 0) = swap(2, 2) = swap(3, 3) = 1.0;
  Pose result;
  result.matrix() = swap * pose.matrix() * swap;
  return result;
}

template <typename Change>
PoseConvention changed(const char* name, const char* remedy, const std::vector<Pose>& poses,
                       Change&& change) {
  PoseConvention convention{name, remedy, {}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    convention.map_from_sensor.push_back(change(i));
  }
  return convention;
}

}  // namespace

Pose PoseConvention::motion(const ScanPair& pair) const {
  const Pose between = relative(map_from_sensor, pair);
  return swaps_xy ? swapped_xy(between) : between;
}

std::vector<PoseConvention> other_conventions(const std::vector<Pose>& given,
                                              const std::optional<Pose>& camera_from_lidar,
                                              bool applied) {
  Pose looks_ahead = Pose::Identity();
  looks_ahead.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Pose tr = camera_from_lidar.value_or(looks_ahead);
  const std::size_t last = given.size() - 1;
  const auto stored = [&](std::size_t i) {
    return applied ? tr * given[i] * tr.inverse() : given[i];
  };
  const auto as_read = [&](const Pose& pose) { return applied ? lidar_pose(pose, tr) : pose; };
  std::vector<PoseConvention> conventions;
  if (applied) {
    conventions.push_back(
        changed("the lidar's, Tr not to be applied", "run with --pose-frame lidar", given, stored));
  } else {
    conventions.push_back(changed(
        camera_from_lidar ? "the camera's, Tr to be applied" : "the camera's, Tr is missing",
        camera_from_lidar ? "run with --pose-frame camera"
                          : "put the data set's calib.txt with its Tr next to the poses",
        given, [&](std::size_t i) { return lidar_pose(given[i], tr); }));
  }
  conventions.push_back(changed("sensor_from_map (inverse)",
                                "run with --pose-direction sensor-from-map", given,
                                [&](std::size_t i) { return given[i].inverse(); }));
  conventions.push_back(changed("with transposed rotations", "write each row's rotation row by row",
                                given, [&](std::size_t i) {
                                  Pose pose = stored(i);
                                  pose.linear().transposeInPlace();
                                  return as_read(pose);
                                }));
  conventions.push_back(changed("one row later", "remove the first row and add one at the end",
                                given,
                                [&](std::size_t i) { return given[std::min(i + 1, last)]; }));
  conventions.back().shifts_rows = true;
  conventions.push_back(changed("one row earlier", "remove the last row and add one in front",
                                given, [&](std::size_t i) { return given[i > 0 ? i - 1 : 0]; }));
  conventions.back().shifts_rows = true;
  conventions.push_back(changed("right, but x and y of the points are swapped",
                                "export the scans again with x before y", given,
                                [&](std::size_t i) { return given[i]; }));
  conventions.back().swaps_xy = true;
  return conventions;
}

}  // namespace mosbench
