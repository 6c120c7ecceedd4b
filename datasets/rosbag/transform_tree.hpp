#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/sequence/pose_track.hpp"

namespace mosbench {

/// The transforms from a frame to one of its ancestors, whose product is to_from_from.
class TransformChain {
 public:
  /// Returns nothing where a transform is not known, or lies in a hole of more than the limit.
  std::optional<Pose> at(std::int64_t stamp_ns) const;
  /// Returns whether `at` gives poses from one time to the other.
  bool covers(std::int64_t from_ns, std::int64_t to_ns) const;
  /// Returns whether some transform of it changes.
  bool moves() const;
  /// Returns the first transform that does not cover the time, and when it is known: "odom from
  /// base_link is known from 3.000 to 9.000 s"; empty where all do.
  std::string lacks(std::int64_t stamp_ns) const;
  /// Returns what is odd about its transforms: that two publishers contradict each other.
  const std::vector<std::string>& doubts() const { return doubts_; }

 private:
  friend class TransformTree;
  struct Link {
    std::string name;  ///< "odom from base_link"
    PoseTrack track;
  };
  std::vector<Link> links_;
  std::vector<std::string> doubts_;
  std::int64_t most_gap_ns_ = 0;
};

/// The tf tree of a bag. Only the transforms on the way that is asked for are judged.
class TransformTree {
 public:
  /// An `always` transform, of /tf_static, holds at all times, unless the same one changes.
  TransformTree(const std::vector<StampedTransform>& transforms,
                const std::vector<StampedTransform>& always, const std::filesystem::path& file);

  /// Returns the frames from `from` up to `to`, `from` first: the shortest way where a frame has
  /// several parents; empty when `to` is no ancestor.
  std::vector<std::string> way(const std::string& from, const std::string& to) const;
  /// Returns the frames from `from` up to "map", else to the root. Throws DataError where one has
  /// two parents, unless only one leads to a transform that changes.
  std::vector<std::string> ancestors(const std::string& from) const;

  /// Returns the transforms along a way, with holes longer than a time.
  TransformChain chain(const std::vector<std::string>& way, double max_gap_s) const;

 private:
  /// Whether the transform to a parent changes, or one above it.
  bool moves_above(const std::string& child, const std::string& parent,
                   std::set<std::string> seen) const;

  using Edge = std::pair<std::string, std::string>;  ///< child, parent
  std::map<std::string, std::map<std::string, PoseTrack>> parents_of_;
  std::map<Edge, std::string> doubts_of_;
  const std::filesystem::path& file_;
};

}  // namespace mosbench
