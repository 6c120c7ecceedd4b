#include "datasets/sequence/undistort.hpp"

#include <unordered_map>

namespace mosbench {
namespace {

Point moved(const Pose& pose, const Point& point) {
  const Eigen::Vector3d p = pose * Eigen::Vector3d(point.x, point.y, point.z);
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          point.intensity};
}

}  // namespace

bool undistort(std::span<Point> points, std::span<const std::int64_t> times_ns,
               std::int64_t stamp_ns, std::int64_t reference_ns, const PoseAt& map_from_sensor) {
  const std::optional<Pose> reference = map_from_sensor(reference_ns);
  if (!reference) return false;
  const Pose reference_from_map = reference->inverse();
  // All points of a column of a spinning sensor have the same time.
  std::unordered_map<std::int64_t, Pose> reference_from_time;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int64_t at_ns = stamp_ns + times_ns[i];
    if (at_ns == reference_ns) continue;
    auto known = reference_from_time.find(at_ns);
    if (known == reference_from_time.end()) {
      const std::optional<Pose> pose = map_from_sensor(at_ns);
      if (!pose) return false;
      known = reference_from_time.emplace(at_ns, reference_from_map * *pose).first;
    }
    points[i] = moved(known->second, points[i]);
  }
  return true;
}

}  // namespace mosbench
