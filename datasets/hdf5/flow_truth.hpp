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

/// How far a point that moves goes at least until the next scan, whatever their stamps, as
/// OpenSceneFlow's evaluation says.
inline constexpr double kFlowMovingStep_m = 0.05;
/// The last category of Argoverse 2; OpenSceneFlow counts points of later ones nowhere.
inline constexpr std::uint8_t kLastFlowCategory = 30;

/// Ids of truth beside 0 (the flow is not valid), 9 and 251.
inline constexpr std::uint32_t kGroundLabel = 40;     ///< static, on the ground
inline constexpr std::uint32_t kLeftOutStatic = 99;   ///< static, not evaluated
inline constexpr std::uint32_t kLeftOutMoving = 259;  ///< moving, not evaluated

/// Where the sensor is at the next scan, and when.
struct SensorStep {
  Pose next_from_sensor = Pose::Identity();
  double time_s = 0.0;
};

/// Returns the flow without the part that the sensor's motion makes: flow - (T p - p) in the sensor
/// frame, NaN where `valid` is 0 or the flow is not finite. `flow_m` has three numbers per point,
/// `valid` one.
std::vector<Eigen::Vector3d> displacements(std::span<const Point> points,
                                           std::span<const float> flow_m,
                                           std::span<const std::int64_t> valid,
                                           const SensorStep& step);

/// Returns the displacements per second.
std::vector<Eigen::Vector3f> velocities(std::span<const Eigen::Vector3d> displacements_m,
                                        const SensorStep& step);

/// Returns the flow that `displacements` and `velocities` turn into these velocities; 0 where they
/// are NaN.
std::vector<float> flow_of(std::span<const Point> points,
                           std::span<const Eigen::Vector3f> velocities_m_s, const SensorStep& step);

/// Returns one label per point: 0 where the displacement is not known, else whether its length is
/// `moving_step_m` or more. Points that are not evaluated (on the ground, outside of eval_mask or
/// of a later category) have ids of their own.
std::vector<std::uint32_t> flow_labels(std::span<const Eigen::Vector3d> displacements_m,
                                       const PointMotions& motions, double moving_step_m);

}  // namespace mosbench
