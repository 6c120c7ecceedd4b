#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/sequence/pose_track.hpp"

namespace mosbench {

/// The tf tree of a bag: every frame has one parent.
class TransformTree {
 public:
  /// An `always` transform, of /tf_static, holds at all times. Throws DataError when a frame has
  /// two parents.
  TransformTree(const std::vector<StampedTransform>& transforms,
                const std::vector<StampedTransform>& always, const std::filesystem::path& file);

  /// Returns the frames from `frame` up to the root, `frame` first.
  std::vector<std::string> ancestors(const std::string& frame) const;

  /// Tracks whose product, first to last, is to_from_from: those of `from` and its ancestors below
  /// `to`.
  class Chain {
   public:
    /// Returns nothing when a track does not cover the time.
    std::optional<Pose> at(std::int64_t stamp_ns) const;

   private:
    friend class TransformTree;
    std::vector<PoseTrack> tracks_;
  };
  /// Returns nothing when `to` is not an ancestor of `from`.
  std::optional<Chain> chain(const std::string& to, const std::string& from) const;

 private:
  struct Edge {
    std::string parent;
    PoseTrack track;
  };
  std::map<std::string, Edge> edge_of_child_;
};

/// Returns the topic of PointCloud2, or of CustomMsg of Livox, that was asked for, else that of
/// DOALS, else the only one. Throws DataError that lists the topics of the bag.
std::string cloud_topic(const BagReader& bag, const std::optional<std::string>& asked);

struct BagTransforms {
  TransformTree::Chain map_from_sensor;
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
                             const std::optional<std::string>& pose_topic = std::nullopt);

}  // namespace mosbench
