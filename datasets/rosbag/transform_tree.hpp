#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

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
    bool covers(std::int64_t from_ns, std::int64_t to_ns) const;

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

}  // namespace mosbench
