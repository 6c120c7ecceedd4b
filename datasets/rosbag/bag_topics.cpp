#include "datasets/rosbag/bag_topics.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/rosbag/ros_messages.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kDoalsTopic = "/os1_cloud_node/points";
constexpr std::string_view kTfStatic = "/tf_static";

std::set<std::string> topics_of_type(const BagFile& bag, std::string_view type) {
  std::set<std::string> topics;
  for (const BagConnection& connection : bag.connections_of_type(type)) {
    topics.insert(connection.topic);
  }
  return topics;
}

std::string listed(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string all_topics(const BagFile& bag) {
  std::set<std::string> topics;
  for (const BagConnection& connection : bag.connections()) {
    topics.insert(connection.topic + " (" + connection.type + ")");
  }
  return topics.empty() ? "nothing" : listed(topics);
}

/// Transforms of a bag and the topics that they come from.
struct Transforms {
  std::vector<StampedTransform> changing, always;
  std::set<std::string> topics;
};

Transforms tf_transforms(const BagFile& bag) {
  Transforms found;
  for (const std::string_view type : {kTfMessage, kOldTfMessage}) {
    for (const std::string& topic : topics_of_type(bag, type)) {
      auto& target = topic.ends_with(kTfStatic) ? found.always : found.changing;
      for (const BagMessage& message : bag.messages(topic)) {
        for (StampedTransform& transform : parse_tf_message(bag.read(message), bag.path())) {
          target.push_back(std::move(transform));
        }
      }
      found.topics.insert(topic);
    }
  }
  return found;
}

Transforms stamped_transforms(const BagFile& bag) {
  Transforms found;
  for (const std::string& topic : topics_of_type(bag, kTransformStamped)) {
    for (const BagMessage& message : bag.messages(topic)) {
      found.changing.push_back(parse_transform(bag.read(message), bag.path()));
    }
    found.topics.insert(topic);
  }
  return found;
}

std::string frames_of(const Transforms& transforms) {
  std::set<std::string> frames;
  for (const auto* source : {&transforms.changing, &transforms.always}) {
    for (const StampedTransform& transform : *source) {
      frames.insert(transform.parent);
      frames.insert(transform.child);
    }
  }
  return frames.empty() ? "no frame" : listed(frames);
}

std::optional<BagTransforms> find_chain(const Transforms& transforms, const BagFile& bag,
                                        const std::optional<std::string>& map_frame,
                                        const std::string& sensor_frame) {
  const TransformTree tree(transforms.changing, transforms.always, bag.path());
  const auto frames = tree.ancestors(sensor_frame);
  const bool has_map = std::ranges::find(frames, "map") != frames.end();
  const std::string map = map_frame.value_or(has_map ? "map" : frames.back());
  if (map == sensor_frame) return std::nullopt;
  auto chain = tree.chain(map, sensor_frame);
  if (!chain) return std::nullopt;
  return BagTransforms{std::move(*chain),
                       listed(transforms.topics) + ", " + map + " from " + sensor_frame};
}

}  // namespace

std::string cloud_topic(const BagFile& bag, const std::optional<std::string>& asked) {
  const auto topics = topics_of_type(bag, kPointCloud2);
  if (asked && topics.contains(*asked)) return *asked;
  if (asked) {
    throw DataError(bag.path(), "has no PointCloud2 topic " + *asked,
                    "one of what it holds: " + all_topics(bag));
  }
  if (topics.empty()) {
    throw DataError(bag.path(), "holds no sensor_msgs/PointCloud2 but " + all_topics(bag),
                    "scans as PointCloud2");
  }
  if (topics.contains(std::string(kDoalsTopic))) return std::string(kDoalsTopic);
  if (topics.size() == 1) return *topics.begin();
  throw DataError(bag.path(), "holds several PointCloud2 topics: " + listed(topics),
                  "one of them in --topic");
}

BagTransforms bag_transforms(const BagFile& bag, const std::optional<std::string>& map_frame,
                             const std::string& sensor_frame) {
  const Transforms tf = tf_transforms(bag);
  if (auto found = find_chain(tf, bag, map_frame, sensor_frame)) return *found;
  const Transforms stamped = stamped_transforms(bag);
  if (auto found = find_chain(stamped, bag, map_frame, sensor_frame)) return *found;
  throw DataError(
      bag.path(),
      "no transforms lead from " + map_frame.value_or("a map") + " to " + sensor_frame +
          " (/tf: " + frames_of(tf) + "; TransformStamped: " + frames_of(stamped) + ")",
      "such a chain, or --poses FILE, and --map-frame if the map is called otherwise; or "
      "poses found from the scans: mosbench run " +
          bag.path().parent_path().string() + " --odometry simple");
}

}  // namespace mosbench
