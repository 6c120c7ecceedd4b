#include "datasets/rosbag/bag_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kDoalsTopic = "/os1_cloud_node/points";
constexpr std::string_view kTfStatic = "/tf_static";

std::set<std::string> topics_of_type(const BagReader& bag, std::string_view type) {
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

std::string all_topics(const BagReader& bag) {
  std::set<std::string> topics;
  for (const BagConnection& connection : bag.connections()) {
    topics.insert(connection.topic + " (" + connection.type + ")");
  }
  return topics.empty() ? "nothing" : listed(topics);
}

/// The tf tree of a bag: every frame has one parent.
class TransformTree {
 public:
  /// An `always` transform, of /tf_static, holds at all times. Throws DataError when a frame has
  /// two parents.
  TransformTree(const std::vector<StampedTransform>& transforms,
                const std::vector<StampedTransform>& always, const std::filesystem::path& file) {
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
        poses_of_child[transform.child].emplace_back(transform.stamp_ns,
                                                     transform.parent_from_child);
      }
      for (auto& [child, poses] : poses_of_child) {
        edge_of_child_[child].track = PoseTrack(std::move(poses), holds_always);
      }
    };
    add(transforms, false);
    add(always, true);
  }

  /// Returns the frames from `frame` up to the root, `frame` first.
  std::vector<std::string> ancestors(const std::string& frame) const {
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

  /// Tracks whose product, first to last, is to_from_from: those of `from` and its ancestors below
  /// `to`.
  class Chain {
   public:
    /// Returns nothing when a track does not cover the time.
    std::optional<Pose> at(std::int64_t stamp_ns) const {
      std::optional<Pose> product;
      for (const PoseTrack& track : tracks_) {
        const std::optional<Pose> pose = track.at(stamp_ns);
        if (!pose) return std::nullopt;
        product = product ? Pose(*product * *pose) : *pose;
      }
      return product ? product : Pose::Identity();
    }

   private:
    friend class TransformTree;
    std::vector<PoseTrack> tracks_;
  };
  /// Returns nothing when `to` is not an ancestor of `from`.
  std::optional<Chain> chain(const std::string& to, const std::string& from) const {
    const std::vector<std::string> frames = ancestors(from);
    const auto end = std::ranges::find(frames, to);
    if (end == frames.end()) return std::nullopt;
    Chain chain;
    for (auto frame = frames.begin(); frame != end; ++frame) {
      chain.tracks_.insert(chain.tracks_.begin(), edge_of_child_.at(*frame).track);
    }
    return chain;
  }

 private:
  struct Edge {
    std::string parent;
    PoseTrack track;
  };
  std::map<std::string, Edge> edge_of_child_;
};

/// Transforms of a bag and the topics that they come from.
struct Transforms {
  std::vector<StampedTransform> changing, always;
  std::set<std::string> topics;
};

/// Appends what a topic says.
void add_transforms(const BagReader& bag, const std::string& topic,
                    std::vector<StampedTransform>& transforms) {
  for (const BagMessage& message : bag.messages(topic)) {
    for (StampedTransform& transform :
         parse_transforms(bag.read(message), bag.format_of(message), bag.path())) {
      transforms.push_back(std::move(transform));
    }
  }
}

/// What all topics of these types say.
Transforms transforms_of(const BagReader& bag, std::initializer_list<std::string_view> types) {
  Transforms found;
  for (const std::string_view type : types) {
    for (const std::string& topic : topics_of_type(bag, type)) {
      const bool always =
          topic.ends_with(kTfStatic) && (type == kTfMessage || type == kOldTfMessage);
      add_transforms(bag, topic, always ? found.always : found.changing);
      found.topics.insert(topic);
    }
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

/// Finds the poses of the sensor's frame in that of the map: see `bag_transforms`.
class PoseSearch {
 public:
  PoseSearch(const BagReader& bag, const std::optional<std::string>& map_frame,
             const std::string& sensor_frame)
      : bag_(bag), map_frame_(map_frame), sensor_frame_(sensor_frame) {}

  BagTransforms run(const std::optional<std::string>& pose_topic) const {
    if (auto found = pose_topic ? of_topic(*pose_topic) : of_first_kind()) return *std::move(found);
    throw MissingPoses(
        bag_.path(),
        "no transforms lead from " + map_frame_.value_or("a map") + " to " + sensor_frame_ +
            " (/tf: " + frames_of(tf_) + "; TransformStamped: " + frames_of(stamped_) +
            "; Odometry: " + frames_of(transforms_of(bag_, {kOdometry})) + ")",
        fmt::format("such a chain ({} names a map that is called otherwise), {}, or poses found by "
                    "odometry",
                    option("map_frame"), option("poses", "FILE")));
  }

 private:
  /// The poses of one topic of Odometry, PoseStamped or Path. A Path repeats what the one before
  /// had: the last is whole. Poses without child are the sensor's.
  Transforms poses_in(std::string_view type, const std::string& topic) const {
    Transforms found{{}, tf_.always, {topic}};
    if (type == kPath) {
      const std::vector<BagMessage> messages = bag_.messages(topic);
      if (messages.empty()) return found;
      found.changing = parse_transforms(bag_.read(messages.back()), bag_.format_of(messages.back()),
                                        bag_.path());
    } else {
      add_transforms(bag_, topic, found.changing);
    }
    // A frame has one parent: what is fixed above it is not the way to these poses.
    std::set<std::string> posed;
    for (StampedTransform& transform : found.changing) {
      if (transform.child.empty()) transform.child = sensor_frame_;
      posed.insert(transform.child);
    }
    std::erase_if(found.always, [&](const auto& fixed) { return posed.contains(fixed.child); });
    return found;
  }

  std::optional<BagTransforms> chain_of(const Transforms& transforms) const {
    const TransformTree tree(transforms.changing, transforms.always, bag_.path());
    const auto frames = tree.ancestors(sensor_frame_);
    const auto named_map = std::ranges::find(frames, "map");
    const std::string map = map_frame_.value_or(named_map != frames.end() ? "map" : frames.back());
    if (map == sensor_frame_) return std::nullopt;
    const auto moves = [&](const StampedTransform& transform) {
      return std::ranges::find(frames, transform.child) < std::ranges::find(frames, map);
    };
    // How the sensor is mounted is no pose of it.
    if (!map_frame_ && std::ranges::none_of(transforms.changing, moves)) return std::nullopt;
    auto chain = tree.chain(map, sensor_frame_);
    if (!chain) return std::nullopt;
    return BagTransforms{
        [chain = *std::move(chain)](std::int64_t stamp_ns) { return chain.at(stamp_ns); },
        listed(transforms.topics) + ", " + map + " from " + sensor_frame_};
  }

  /// The one topic of a type whose poses lead to the sensor.
  std::optional<BagTransforms> of_type(std::string_view type) const {
    std::optional<BagTransforms> found;
    std::set<std::string> fitting;
    for (const std::string& topic : topics_of_type(bag_, type)) {
      const Transforms poses = poses_in(type, topic);
      // A single one is a goal or a start, and no way of the sensor.
      if (poses.changing.size() < 2) continue;
      auto chain = chain_of(poses);
      if (!chain) continue;
      fitting.insert(topic);
      found = std::move(chain);
    }
    if (fitting.size() > 1) {
      throw DataError(
          bag_.path(), "has poses in the topics " + listed(fitting),
          fmt::format("one of them in {}, or {}", option("pose_topic"), option("poses", "FILE")));
    }
    return found;
  }

  /// The topic that the user named.
  std::optional<BagTransforms> of_topic(const std::string& topic) const {
    std::set<std::string> others;
    for (const std::string_view type : {kTransformStamped, kOdometry, kPoseStamped, kPath}) {
      std::set<std::string> topics = topics_of_type(bag_, type);
      if (topics.contains(topic)) return chain_of(poses_in(type, topic));
      others.merge(topics);
    }
    throw DataError(
        bag_.path(), "has no topic of poses " + topic,
        others.empty() ? option("poses", "FILE") + ", as it has none" : "one of " + listed(others));
  }

  std::optional<BagTransforms> of_first_kind() const {
    auto found = chain_of(tf_);
    if (!found) found = chain_of(stamped_);
    for (const std::string_view type : {kOdometry, kPoseStamped, kPath}) {
      if (!found) found = of_type(type);
    }
    return found;
  }

  const BagReader& bag_;
  const std::optional<std::string>& map_frame_;
  const std::string& sensor_frame_;
  Transforms tf_ = transforms_of(bag_, {kTfMessage, kOldTfMessage});
  Transforms stamped_ = transforms_of(bag_, {kTransformStamped});
};

}  // namespace

std::string cloud_topic(const BagReader& bag, const std::optional<std::string>& asked) {
  std::set<std::string> topics = topics_of_type(bag, kPointCloud2);
  for (const std::string_view type : kLivoxMessages) topics.merge(topics_of_type(bag, type));
  if (asked && topics.contains(*asked)) return *asked;
  if (asked) {
    throw DataError(bag.path(), "has no PointCloud2 topic " + *asked,
                    "one of what it holds: " + all_topics(bag));
  }
  if (topics.empty()) {
    throw DataError(
        bag.path(), "holds no sensor_msgs/PointCloud2 but " + all_topics(bag),
        "scans as PointCloud2; of a folder with bags " + option("sequences") + " picks others");
  }
  if (topics.contains(std::string(kDoalsTopic))) return std::string(kDoalsTopic);
  if (topics.size() == 1) return *topics.begin();
  throw DataError(bag.path(), "holds several PointCloud2 topics: " + listed(topics),
                  "one of them in " + option("topic"));
}

BagTransforms bag_transforms(const BagReader& bag, const std::optional<std::string>& map_frame,
                             const std::string& sensor_frame,
                             const std::optional<std::string>& pose_topic) {
  return PoseSearch(bag, map_frame, sensor_frame).run(pose_topic);
}

}  // namespace mosbench
