#pragma once

#include <optional>
#include <string>

#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/sequence/corrected_sequence.hpp"

namespace mosbench {

/// Returns the topic of PointCloud2, or of CustomMsg of Livox, that was asked for, else that of
/// DOALS, else the only one. Throws DataError that lists the topics of the bag.
std::string cloud_topic(const BagReader& bag, const std::optional<std::string>& asked);

struct BagTransforms {
  PoseAt map_from_sensor;
  std::string source;  ///< "/tf, map from os1_lidar"
};

/// Returns the transforms from the sensor's frame to `map_frame`. If that is not given, to "map" if
/// it is an ancestor, else to the root. Searches /tf with /tf_static first; then topics of
/// TransformStamped; then topics of Odometry with /tf_static, of PoseStamped and of Path, both
/// taken as the sensor's poses. If `pose_topic` is given, only that. Throws MissingPoses that lists
/// the frames of the bag; DataError for poses of the same type in several topics, and for a
/// `pose_topic` that holds none.
BagTransforms bag_transforms(const BagReader& bag, const std::optional<std::string>& map_frame,
                             const std::string& sensor_frame,
                             const std::optional<std::string>& pose_topic);

}  // namespace mosbench
