#include "datasets/rosbag/bag_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

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

/// Transforms of a bag and the topics that they come from.
struct Transforms {
  std::vector<StampedTransform> changing, always;
  std::set<std::string> topics;
  std::size_t poses = 0;   ///< of a topic of poses
  std::string doubt = {};  ///< whose they are
};

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

/// A way of the sensor that was found.
struct Way {
  TransformChain chain;
  std::vector<std::string> frames;  ///< the sensor's first, the map's last
  std::string source, doubt;
};

/// Finds the poses of the sensor's frame in that of the map: see `bag_transforms`.
class PoseSearch {
 public:
  PoseSearch(const BagReader& bag, const Reading& asked, const std::string& sensor_frame)
      : bag_(bag), asked_(asked), map_frame_(asked.map_frame), sensor_frame_(sensor_frame) {}

  BagTransforms run() {
    std::optional<Way> found = asked_.pose_topic ? of_topic(*asked_.pose_topic) : of_first_kind();
    std::vector<std::string> remarks = ignored();
    if (found && found->chain.moves()) return result(std::move(*found), std::move(remarks), "");
    const Transforms odometry = transforms_of({kOdometry});
    const std::string offer = offered(odometry);
    if (found) return result(std::move(*found), std::move(remarks), offer);
    throw MissingPoses(
        bag_.path(),
        (sensor_frame_.empty()
             ? "the scans name no frame"
             : "no transforms lead from " + map_frame_.value_or("a map") + " to " + sensor_frame_) +
            " (/tf: " + frames_of(tf_) + "; TransformStamped: " + frames_of(stamped_) +
            "; Odometry: " + frames_of(odometry) + ")" + in_brackets(ignored()),
        fmt::format("such a chain ({} names a map that is called otherwise), {}{}, or poses found "
                    "by odometry",
                    option("map_frame"), offer.empty() ? "" : offer + " if it is of the sensor, ",
                    option("poses", "FILE")));
  }

 private:
  BagTransforms result(Way way, std::vector<std::string> remarks, const std::string& offer) const {
    std::vector<std::string> doubts = way.chain.doubts();
    if (!way.doubt.empty()) doubts.push_back(std::move(way.doubt));
    if (!offer.empty()) {
      doubts.push_back(fmt::format(
          "the poses do not change, those of Odometry do: if these are of {}, ask for {}",
          sensor_frame_, offer));
    }
    return {std::move(way.chain), std::move(way.source), std::move(remarks), std::move(doubts)};
  }

  /// Returns how to ask for the one topic of Odometry as the sensor's; empty where none moves.
  std::string offered(const Transforms& odometry) const {
    const auto moves = [&](const StampedTransform& pose) {
      return pose.parent_from_child.matrix() !=
             odometry.changing.front().parent_from_child.matrix();
    };
    const bool is_odometry = odometry.topics.size() == 1 && !asked_.pose_topic;
    if (!is_odometry || sensor_frame_.empty() || std::ranges::none_of(odometry.changing, moves))
      return "";
    return option("pose_topic", *odometry.topics.begin() + "@" + sensor_frame_);
  }

  /// Says which transforms were ignored.
  std::vector<std::string> ignored() const {
    std::set<std::string> frames;
    std::size_t count = 0;
    for (const auto& [frame, times] : unsound_) {
      if (times == 0) continue;
      frames.insert(frame.empty() ? "no frame" : frame);
      count += times;
    }
    if (count == 0) return {};
    return {fmt::format("{} of {} ignored, as tf2 does: not finite, no rotation, or without frames",
                        counted(count, "transform"),
                        listed(frames) + (count == 1 ? " is" : " are"))};
  }

  static std::string in_brackets(const std::vector<std::string>& remarks) {
    return remarks.empty() ? "" : " (" + remarks.front() + ")";
  }

  /// Appends what a topic says, but for what tf2 ignores.
  void add_transforms(const std::string& topic, std::vector<StampedTransform>& transforms) {
    for (const BagMessage& message : bag_.messages(topic)) {
      take(parse_transforms(bag_.read(message), bag_.format_of(message), bag_.path()), transforms);
    }
  }

  void take(std::vector<StampedTransform> parsed, std::vector<StampedTransform>& transforms) {
    for (StampedTransform& transform : parsed) {
      if (transform.is_sound) {
        transform.stamp_ns = asked_.moved_ns(transform.stamp_ns);
        transforms.push_back(std::move(transform));
      } else {
        ++unsound_[transform.child];
      }
    }
  }

  /// What all topics of these types say.
  Transforms transforms_of(std::initializer_list<std::string_view> types) {
    Transforms found;
    for (const std::string_view type : types) {
      for (const std::string& topic : topics_of_type(bag_, type)) {
        const bool always =
            topic.ends_with(kTfStatic) && (type == kTfMessage || type == kOldTfMessage);
        add_transforms(topic, always ? found.always : found.changing);
        found.topics.insert(topic);
      }
    }
    return found;
  }

  /// The poses of one topic of Odometry, PoseStamped or Path. A Path repeats what the one before
  /// had: the last is whole. Poses without child are the sensor's, or of the frame that was asked.
  Transforms poses_in(std::string_view type, const std::string& topic) {
    Transforms found{{}, tf_.always, {topic}};
    if (type == kPath) {
      const std::vector<BagMessage> messages = bag_.messages(topic);
      if (messages.empty()) return found;
      take(parse_transforms(bag_.read(messages.back()), bag_.format_of(messages.back()),
                            bag_.path()),
           found.changing);
    } else {
      add_transforms(topic, found.changing);
    }
    name_map(found.changing);
    found.poses = found.changing.size();
    std::set<std::string> posed;
    for (StampedTransform& transform : found.changing) {
      if (posed_frame_) transform.child = *posed_frame_;
      if (transform.child.empty()) {
        transform.child = sensor_frame_;
        found.doubt = doubt_about_frame(topic);
      }
      posed.insert(transform.child);
    }
    // A frame has one parent: what is fixed above it is not the way to these poses.
    std::erase_if(found.always, [&](const auto& fixed) { return posed.contains(fixed.child); });
    add_mounts(posed, found);
    return found;
  }

  /// Poses of which none names its map are in that asked for; else those that name none are
  /// ignored.
  void name_map(std::vector<StampedTransform>& poses) {
    const auto has_none = [](const StampedTransform& pose) { return pose.parent.empty(); };
    if (std::ranges::all_of(poses, has_none)) {
      for (StampedTransform& pose : poses) pose.parent = map_frame_.value_or("map");
    }
    unsound_[""] += std::erase_if(poses, has_none);
  }

  /// What is doubtful about poses without a frame where the sensor is mounted on another.
  std::string doubt_about_frame(const std::string& topic) const {
    const auto mount = [&](const StampedTransform& transform) {
      return transform.child == sensor_frame_ && !is_identity(transform.parent_from_child);
    };
    for (const auto* source : {&tf_.changing, &tf_.always}) {
      const auto found = std::ranges::find_if(*source, mount);
      if (found == source->end()) continue;
      return fmt::format(
          "poses of {} name no frame and are taken as those of {}: if they are of "
          "{}, ask for {}",
          topic, sensor_frame_, found->parent, option("pose_topic", topic + "@" + found->parent));
    }
    return "";
  }

  /// Adds the transforms of /tf by which the sensor is mounted on a frame with poses. One that
  /// never changes holds at all times, as if it were in /tf_static.
  void add_mounts(const std::set<std::string>& posed, Transforms& found) const {
    for (const std::string& frame : posed) {
      const std::vector<std::string> way = tf_tree_.way(sensor_frame_, frame);
      for (std::size_t i = 0; i + 1 < way.size(); ++i) {
        const bool moves = tf_tree_.chain({way[i], way[i + 1]}, asked_.max_pose_gap_s).moves();
        for (const StampedTransform& transform : tf_.changing) {
          if (transform.child != way[i] || transform.parent != way[i + 1]) continue;
          (moves ? found.changing : found.always).push_back(transform);
        }
      }
      if (way.size() > 1) found.topics.insert(tf_.topics.begin(), tf_.topics.end());
    }
  }

  TransformTree tree_of(const Transforms& transforms) const {
    return {transforms.changing, transforms.always, bag_.path()};
  }

  std::optional<Way> way_of(const Transforms& transforms) const {
    return way_of(transforms, tree_of(transforms));
  }

  std::optional<Way> way_of(const Transforms& transforms, const TransformTree& tree) const {
    const std::vector<std::string> frames =
        map_frame_ ? tree.way(sensor_frame_, *map_frame_) : tree.ancestors(sensor_frame_);
    if (frames.size() < 2) return std::nullopt;
    const auto changes = [&](const StampedTransform& transform) {
      return std::ranges::find(frames, transform.child) < std::prev(frames.end());
    };
    // How the sensor is mounted is no pose of it.
    if (!map_frame_ && std::ranges::none_of(transforms.changing, changes)) return std::nullopt;
    return Way{tree.chain(frames, asked_.max_pose_gap_s), frames,
               listed(transforms.topics) + ", " + frames.back() + " from " + sensor_frame_,
               transforms.doubt};
  }

  /// The one topic of a type whose poses lead to the sensor.
  std::optional<Way> of_type(std::string_view type) {
    std::optional<Way> found;
    std::set<std::string> fitting;
    for (const std::string& topic : topics_of_type(bag_, type)) {
      const Transforms poses = poses_in(type, topic);
      // A single one is a goal or a start, and no way of the sensor.
      if (poses.poses < 2) continue;
      auto way = way_of(poses);
      if (!way) continue;
      fitting.insert(topic);
      found = std::move(way);
    }
    if (fitting.size() > 1) {
      throw DataError(
          bag_.path(), "has poses in the topics " + listed(fitting),
          fmt::format("one of them in {}, or {}", option("pose_topic"), option("poses", "FILE")));
    }
    return found;
  }

  /// The topic that the user named, "TOPIC" or "TOPIC@FRAME".
  std::optional<Way> of_topic(const std::string& asked) {
    const std::size_t at = asked.find('@');
    const std::string topic = asked.substr(0, at);
    if (at != asked.npos) posed_frame_ = asked.substr(at + 1);
    std::set<std::string> others;
    for (const std::string_view type :
         {kTransformStamped, kOdometry, kPoseStamped, kPoseWithCovarianceStamped, kPath}) {
      std::set<std::string> topics = topics_of_type(bag_, type);
      if (topics.contains(topic)) return way_of(poses_in(type, topic));
      others.merge(topics);
    }
    throw DataError(
        bag_.path(), "has no topic of poses " + topic,
        others.empty() ? option("poses", "FILE") + ", as it has none" : "one of " + listed(others));
  }

  /// Whether Odometry says where a frame is: transforms below it are a mount, even a turning one.
  bool has_odometry_of(const std::string& frame) {
    for (const std::string& topic : topics_of_type(bag_, kOdometry)) {
      const std::vector<BagMessage> messages = bag_.messages(topic);
      if (messages.size() < 2) continue;
      const BagMessage& last = messages.back();
      if (parse_transforms(bag_.read(last), bag_.format_of(last), bag_.path()).front().child ==
          frame) {
        return true;
      }
    }
    return false;
  }

  /// The first that moves; else the first.
  std::optional<Way> of_first_kind() {
    std::optional<Way> standing;
    const auto is_the_way = [&](std::optional<Way> way, bool may_be_mount) {
      if (!way) return false;
      const bool fits = map_frame_ || (way->chain.moves() &&
                                       !(may_be_mount && has_odometry_of(way->frames.back())));
      if (fits || !standing) standing = std::move(way);
      return fits;
    };
    if (is_the_way(way_of(tf_, tf_tree_), true) || is_the_way(way_of(stamped_), true))
      return standing;
    for (const std::string_view type :
         {kOdometry, kPoseStamped, kPoseWithCovarianceStamped, kPath}) {
      if (is_the_way(of_type(type), false)) return standing;
    }
    return standing;
  }

  const BagReader& bag_;
  const Reading& asked_;
  const std::optional<std::string>& map_frame_;
  const std::string& sensor_frame_;
  std::optional<std::string> posed_frame_;      ///< of poses, as the user says
  std::map<std::string, std::size_t> unsound_;  ///< transforms that are ignored, by frame
  Transforms tf_ = transforms_of({kTfMessage, kOldTfMessage});
  TransformTree tf_tree_ = tree_of(tf_);
  Transforms stamped_ = transforms_of({kTransformStamped});
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
                  fmt::format("one of them, {}, or two to six of a rig, which are merged: {}",
                              option("topic", *topics.begin()),
                              option("lidars", fmt::format("{}", fmt::join(topics, ",")))));
}

BagTransforms bag_transforms(const BagReader& bag, const Reading& asked,
                             const std::string& sensor_frame) {
  return PoseSearch(bag, asked, sensor_frame).run();
}

}  // namespace mosbench
