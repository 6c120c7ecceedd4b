#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "datasets/sequence/point_motions.hpp"

namespace mosbench {

/// From which speed on a point moves, as Argoverse 2's and OpenSceneFlow's evaluation say: 0.05 m
/// in the 0.1 s to the next scan.
inline constexpr double kFlowMovingSpeed_m_s = 0.5;

/// Ids of truth beside 0 (the flow is not valid), 9 and 251.
inline constexpr std::uint32_t kGroundLabel = 40;     ///< static, on the ground
inline constexpr std::uint32_t kLeftOutStatic = 99;   ///< static, outside of eval_mask
inline constexpr std::uint32_t kLeftOutMoving = 259;  ///< moving, not evaluated

/// Where the sensor is at the next scan, and when.
struct SensorStep {
  Pose next_from_sensor = Pose::Identity();
  double time_s = 0.0;
};

/// Returns the flow per second without the part that the sensor's motion makes: (flow - (T p - p))
/// / t in the sensor frame, NaN where `valid` is 0 or the flow is not finite. `flow_m` has three
/// numbers per point, `valid` one.
std::vector<Eigen::Vector3f> velocities(std::span<const Point> points,
                                        std::span<const float> flow_m,
                                        std::span<const std::int64_t> valid,
                                        const SensorStep& step);

/// Returns the flow that `velocities` turns into these velocities; 0 where they are NaN.
std::vector<float> flow_of(std::span<const Point> points,
                           std::span<const Eigen::Vector3f> velocities_m_s, const SensorStep& step);

/// Returns one label per point: 0 where the velocity is not known, else whether its length is
/// `moving_speed_m_s` or more. Points that are not evaluated (of eval_mask, else the ground) have
/// ids of their own.
std::vector<std::uint32_t> flow_labels(const PointMotions& motions, double moving_speed_m_s);

}  // namespace mosbench
