#pragma once

#include <optional>
#include <string>

#include "eval/trajectory/trajectory.hpp"

namespace mosbench {

/// Says that the motions of an estimate fit the truth far better if one of the two is turned into
/// the axes of a camera, or is not: a wrong --camera. Without a Tr in `options` the axes are those
/// of KITTI's cameras (x right, z ahead). Empty if the pair fits unchanged.
std::optional<std::string> frame_remark(const TrajectoryPair& pair,
                                        const TrajectoryOptions& options);

}  // namespace mosbench
