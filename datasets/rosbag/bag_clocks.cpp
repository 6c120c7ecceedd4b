#include "datasets/rosbag/bag_clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

/// Poses may be dated a second ahead, scans come some tenths late.
constexpr double kMostApart_s = 1.5;
constexpr std::size_t kMostMessages = 32;

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// The median of stamp minus recording.
double ahead_s(std::span<const MessageTimes> messages) {
  std::vector<double> ahead;
  for (const MessageTimes& message : messages) {
    ahead.push_back(seconds(message.stamp_ns) - seconds(message.recorded_ns));
  }
  return quantile(std::move(ahead), 0.5, QuantileRule::kUpper);
}

/// Some messages of all topics of poses that change.
std::vector<MessageTimes> times_of_poses(const BagReader& bag) {
  std::set<std::string> topics;
  for (const std::string_view type :
       {kTfMessage, kOldTfMessage, kTransformStamped, kOdometry, kPoseStamped}) {
    for (const BagConnection& connection : bag.connections_of_type(type)) {
      if (!connection.topic.ends_with("/tf_static")) topics.insert(connection.topic);
    }
  }
  std::vector<MessageTimes> poses;
  for (const std::string& topic : topics) {
    const std::vector<BagMessage> messages = bag.messages(topic);
    const std::size_t taken = std::min(messages.size(), kMostMessages);
    for (std::size_t i = 0; i < taken; ++i) {
      const BagMessage& message = messages[i * messages.size() / taken];
      const auto transforms =
          parse_transforms(bag.read(message), bag.format_of(message), bag.path());
      if (!transforms.empty()) poses.push_back({transforms[0].stamp_ns, message.recorded_ns});
    }
  }
  return poses;
}

std::string range_of(std::span<const MessageTimes> messages, std::int64_t MessageTimes::*time) {
  const auto [first, last] = std::ranges::minmax(messages, {}, time);
  return fmt::format("{:.3f} to {:.3f} s", seconds(first.*time), seconds(last.*time));
}

}  // namespace

std::optional<std::string> doubt_about_clocks(const BagReader& bag,
                                              std::span<const MessageTimes> scans) {
  const std::vector<MessageTimes> poses = times_of_poses(bag);
  if (scans.empty() || poses.empty()) return std::nullopt;
  const double apart_s = ahead_s(scans) - ahead_s(poses);
  if (std::abs(apart_s) <= kMostApart_s) return std::nullopt;
  return fmt::format(
      "the clock of the scans is {:+.3f} s from that of the poses: scans are stamped {} and were "
      "recorded {}, poses are stamped {}; the times of recording would fit",
      apart_s, range_of(scans, &MessageTimes::stamp_ns),
      range_of(scans, &MessageTimes::recorded_ns), range_of(poses, &MessageTimes::stamp_ns));
}

}  // namespace mosbench
