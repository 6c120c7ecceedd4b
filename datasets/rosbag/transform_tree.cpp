#include "datasets/rosbag/transform_tree.hpp"

#include <algorithm>
#include <utility>

#include "datasets/text/errors.hpp"

namespace mosbench {

TransformTree::TransformTree(const std::vector<StampedTransform>& transforms,
                             const std::vector<StampedTransform>& always,
                             const std::filesystem::path& file) {
  const auto add = [&](const std::vector<StampedTransform>& source, bool holds_always) {
    std::map<std::string, std::vector<std::pair<std::int64_t, Pose>>> poses_of_child;
    for (const StampedTransform& transform : source) {
      auto& edge = edge_of_child_[transform.child];
      if (edge.parent.empty()) edge.parent = transform.parent;
      if (edge.parent != transform.parent) {
        throw DataError(file,
                        "frame " + transform.child + " has the parents " + edge.parent + " and " +
                            transform.parent,
                        "a tf tree");
      }
      poses_of_child[transform.child].emplace_back(transform.stamp_ns, transform.parent_from_child);
    }
    for (auto& [child, poses] : poses_of_child) {
      edge_of_child_[child].track = PoseTrack(std::move(poses), holds_always);
    }
  };
  add(transforms, false);
  add(always, true);
}

std::vector<std::string> TransformTree::ancestors(const std::string& frame) const {
  std::vector<std::string> frames = {frame};
  auto edge = edge_of_child_.find(frame);
  // Parents may form a loop in a damaged bag.
  while (edge != edge_of_child_.end() &&
         std::ranges::find(frames, edge->second.parent) == frames.end()) {
    frames.push_back(edge->second.parent);
    edge = edge_of_child_.find(frames.back());
  }
  return frames;
}

std::optional<TransformTree::Chain> TransformTree::chain(const std::string& to,
                                                         const std::string& from) const {
  const std::vector<std::string> frames = ancestors(from);
  const auto end = std::ranges::find(frames, to);
  if (end == frames.end()) return std::nullopt;
  Chain chain;
  for (auto frame = frames.begin(); frame != end; ++frame) {
    chain.tracks_.insert(chain.tracks_.begin(), edge_of_child_.at(*frame).track);
  }
  return chain;
}

std::optional<Pose> TransformTree::Chain::at(std::int64_t stamp_ns) const {
  std::optional<Pose> product;
  for (const PoseTrack& track : tracks_) {
    const std::optional<Pose> pose = track.at(stamp_ns);
    if (!pose) return std::nullopt;
    product = product ? Pose(*product * *pose) : *pose;
  }
  return product ? product : Pose::Identity();
}

bool TransformTree::Chain::covers(std::int64_t from_ns, std::int64_t to_ns) const {
  return std::ranges::all_of(tracks_,
                             [&](const PoseTrack& track) { return track.covers(from_ns, to_ns); });
}

}  // namespace mosbench
