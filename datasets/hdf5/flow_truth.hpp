#pragma once

#include <array>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// The arrays in a group of an .h5 file of OpenSceneFlow, of N points (its dataprocess/README.md).
/// A group is a scan, named by its stamp.
namespace scene_flow {

inline constexpr std::string_view kLidar = "lidar";  ///< reals (N, 3 or more): x y z [intensity]
inline constexpr std::string_view kPose = "pose";    ///< reals (4, 4), map_from_sensor
inline constexpr std::string_view kGround = "ground_mask";  ///< truth values (N)
/// Reals (N, 3): where a point is after the time to the next scan, seen from the sensor there, less
/// where it is.
inline constexpr std::string_view kFlow = "flow";
inline constexpr std::string_view kValid = "flow_is_valid";          ///< truth values (N)
inline constexpr std::string_view kClass = "flow_category_indices";  ///< of Argoverse 2, (N)
inline constexpr std::string_view kInstance = "flow_instance_id";    ///< int16 (N), 0: none
inline constexpr std::string_view kEgoMotion = "ego_motion";  ///< reals (4, 4), next_from_sensor
inline constexpr std::string_view kEvaluated = "eval_mask";   ///< truth values (N) or (N, 1)
inline constexpr std::string_view kDufo = "dufo";             ///< 0 or 1 (N), 1: moving
inline constexpr std::string_view kOlderDufo = "dufo_label";  ///< its name in files of SeFlow
/// Raw label ids, uint32 (N), where `convert` had truth without speeds. Only mosbench writes it.
inline constexpr std::string_view kLabel = "mos_label";

inline constexpr std::array kAll = {kLidar,    kPose,      kGround,    kFlow, kValid,     kClass,
                                    kInstance, kEgoMotion, kEvaluated, kDufo, kOlderDufo, kLabel};

}  // namespace scene_flow

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
