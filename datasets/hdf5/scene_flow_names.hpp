#pragma once

#include <array>
#include <string_view>

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
}  // namespace mosbench
