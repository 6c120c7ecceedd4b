#include "datasets/hdf5/flow_truth.hpp"

#include <cmath>
#include <limits>

#include "datasets/formats/point_range.hpp"

namespace mosbench {
namespace {

/// The flow of a point that stands still.
Eigen::Vector3d still_flow(const Point& point, const SensorStep& step) {
  const Eigen::Vector3d position = position_of(point);
  return step.next_from_sensor * position - position;
}

}  // namespace

std::vector<Eigen::Vector3d> displacements(std::span<const Point> points,
                                           std::span<const float> flow_m,
                                           std::span<const std::int64_t> valid,
                                           const SensorStep& step) {
  const Eigen::Vector3d unknown =
      Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<Eigen::Vector3d> displacements_m(points.size(), unknown);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (valid[i] == 0) continue;
    const Eigen::Vector3d flow(flow_m[3 * i], flow_m[3 * i + 1], flow_m[3 * i + 2]);
    const Eigen::Vector3d moved = flow - still_flow(points[i], step);
    if (moved.allFinite()) displacements_m[i] = moved;
  }
  return displacements_m;
}

std::vector<Eigen::Vector3f> velocities(std::span<const Eigen::Vector3d> displacements_m,
                                        const SensorStep& step) {
  std::vector<Eigen::Vector3f> velocities_m_s;
  velocities_m_s.reserve(displacements_m.size());
  for (const Eigen::Vector3d& moved : displacements_m) {
    velocities_m_s.push_back((moved / step.time_s).cast<float>());
  }
  return velocities_m_s;
}

std::vector<float> flow_of(std::span<const Point> points,
                           std::span<const Eigen::Vector3f> velocities_m_s,
                           const SensorStep& step) {
  std::vector<float> flow_m;
  flow_m.reserve(3 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d moved = velocities_m_s[i].cast<double>() * step.time_s;
    Eigen::Vector3d flow = Eigen::Vector3d::Zero();
    if (moved.allFinite()) flow = still_flow(points[i], step) + moved;
    for (const double part : {flow.x(), flow.y(), flow.z()}) {
      flow_m.push_back(static_cast<float>(part));
    }
  }
  return flow_m;
}

std::vector<std::uint32_t> flow_labels(std::span<const Eigen::Vector3d> displacements_m,
                                       const PointMotions& motions, double moving_step_m) {
  std::vector<std::uint32_t> labels(displacements_m.size(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double moved_m = displacements_m[i].norm();
    if (std::isnan(moved_m)) continue;
    const bool on_ground = !motions.on_ground.empty() && motions.on_ground[i] != 0;
    const bool masked = motions.evaluated.empty() || motions.evaluated[i] != 0;
    const bool of_category = motions.classes.empty() || motions.classes[i] <= kLastFlowCategory;
    const bool evaluated = masked && of_category && !on_ground;
    if (moved_m >= moving_step_m) {
      labels[i] = evaluated ? kMovingLabel : kLeftOutMoving;
    } else {
      labels[i] = evaluated ? kStaticLabel : on_ground ? kGroundLabel : kLeftOutStatic;
    }
  }
  return labels;
}

}  // namespace mosbench
