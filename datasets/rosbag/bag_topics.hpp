#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/transform_tree.hpp"
#include "datasets/sequence/reading.hpp"

namespace mosbench {

/// Returns the topic of PointCloud2, or of CustomMsg of Livox, that was asked for, else that of
/// DOALS, else the only one. Throws DataError that lists the topics of the bag.
std::string cloud_topic(const BagReader& bag, const std::optional<std::string>& asked);

struct BagTransforms {
  TransformChain map_from_sensor;
  std::string source;  ///< "/tf, map from os1_lidar"
  std::vector<std::string> remarks, doubts;
};

/// Returns the transforms from the sensor's frame to `asked.map_frame`. If that is not given, to
/// "map" if it is an ancestor, else to the root. Searches /tf with /tf_static first; then topics of
/// TransformStamped; then topics of Odometry with the mount of the sensor in /tf or /tf_static, of
/// PoseStamped (with covariance or without) and of Path, all taken as the sensor's poses. Poses of
/// which none names a map are in that asked for. Transforms that never change, or lead
/// to a frame whose Odometry is there, are a mount: they are the way only where there is no other.
/// If `asked.pose_topic` is given, only that; "TOPIC@FRAME" says whose poses these are. Transforms
/// that tf2 ignores are ignored, too, and counted in the remarks. Throws MissingPoses that lists
/// the frames of the bag; DataError for poses of the same type in several topics, for a frame with
/// two parents on the way, and for a topic that holds no poses.
BagTransforms bag_transforms(const BagReader& bag, const Reading& asked,
                             const std::string& sensor_frame);

}  // namespace mosbench
