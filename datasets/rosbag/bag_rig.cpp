#include "datasets/rosbag/bag_rig.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "datasets/rosbag/bag_sequence.hpp"
#include "datasets/rosbag/bag_topics.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/rosbag/transform_tree.hpp"
#include "datasets/sequence/rig_sequence.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// The transforms that never change, in both directions: sensors are siblings in their tree.
std::vector<StampedTransform> mounts_in(const BagReader& bag) {
  std::map<std::pair<std::string, std::string>, StampedTransform> mounts;
  std::set<std::pair<std::string, std::string>> changing;
  for (const char* topic : {"/tf_static", "/tf"}) {
    for (const BagMessage& message : bag.messages(topic)) {
      for (const StampedTransform& mount :
           parse_transforms(bag.read(message), bag.format_of(message), bag.path())) {
        const std::pair frames(mount.parent, mount.child);
        if (!mount.is_sound) continue;
        const auto [known, is_new] = mounts.try_emplace(frames, mount);
        if (!is_new && mount.parent_from_child.matrix() != known->second.parent_from_child.matrix())
          changing.insert(frames);
      }
    }
  }
  std::vector<StampedTransform> both;
  for (auto& [frames, mount] : mounts) {
    if (changing.contains(frames)) continue;
    both.push_back(mount);
    std::swap(mount.parent, mount.child);
    mount.parent_from_child = mount.parent_from_child.inverse();
    both.push_back(std::move(mount));
  }
  return both;
}

/// The frame of the first scan of a topic; BagSequence checks that all have it.
std::string frame_of(const BagReader& bag, const std::string& topic) {
  const std::vector<BagMessage> messages = bag.messages(topic);
  if (messages.empty()) return "";
  const BagMessage& first = messages.front();
  return parse_cloud_head(bag.read(first), bag.path(), bag.format_of(first)).frame;
}

/// Finds mounts in the frame of the first LiDAR.
class Mounts {
 public:
  Mounts(const BagReader& bag, const std::string& first)
      : bag_(bag), known_(mounts_in(bag)), tree_({}, known_, bag.path()), first_(first) {}

  Pose of(const std::string& frame) const {
    const std::vector<std::string> way = tree_.way(frame, first_);
    if (!way.empty()) return *tree_.chain(way, 0).at(0);
    std::set<std::string> frames;
    for (const StampedTransform& mount : known_) frames.insert(mount.child);
    throw DataError(
        bag_.path(),
        fmt::format("no transform that never changes leads from {} to {} ({})", frame, first_,
                    frames.empty() ? "there is none" : fmt::format("{}", fmt::join(frames, ", "))),
        fmt::format("the mounts of both in /tf_static, or one LiDAR in {}", option("lidars")));
  }

 private:
  const BagReader& bag_;
  std::vector<StampedTransform> known_;
  TransformTree tree_;
  std::string first_;
};

}  // namespace

std::unique_ptr<Sequence> open_bag_lidars(
    const std::string& name, const std::function<std::unique_ptr<const BagReader>()>& open,
    const Reading& asked) {
  const std::vector<std::string> topics = lidar_names(asked);
  const std::unique_ptr<const BagReader> bag = open();
  for (const std::string& topic : topics) cloud_topic(*bag, topic);
  const std::string first = frame_of(*bag, topics.front());
  const Mounts mounts(*bag, first);
  std::vector<RigLidar> lidars;
  for (const std::string& topic : topics) {
    const std::string frame = frame_of(*bag, topic);
    Reading reading = lidars.empty() ? asked : without_poses(asked);
    reading.topic = topic;
    const Pose mount = lidars.empty() ? Pose::Identity() : mounts.of(frame);
    auto sequence = std::make_unique<BagSequence>(name, open(), reading);
    lidars.push_back({topic, std::move(sequence), mount});
  }
  if (lidars.size() == 1) return std::move(lidars.front().sequence);
  return std::make_unique<RigSequence>(std::move(lidars));
}

}  // namespace mosbench
