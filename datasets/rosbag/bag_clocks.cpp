#include "datasets/rosbag/bag_clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "datasets/formats/point_times.hpp"
#include "datasets/rosbag/ros_messages.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

/// Poses may be dated a second ahead, scans come some tenths late.
constexpr double kMostApart_s = 1.5;
/// Nothing is recorded before it was measured, but clocks of one machine are set by and by.
constexpr double kMostEarly_s = 0.01;
/// Scans come this much later than poses that are recorded at once only over a slow network.
constexpr double kMostLate_s = 0.4;
constexpr std::size_t kMostMessages = 32;

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// The median of stamp, or of the last point's time, minus recording.
double ahead_s(std::span<const MessageTimes> messages, bool of_last = false) {
  std::vector<double> ahead;
  for (const MessageTimes& message : messages) {
    ahead.push_back(seconds(message.stamp_ns - message.recorded_ns) +
                    (of_last ? seconds(message.last_ns) : 0.0));
  }
  return quantile(std::move(ahead), 0.5, QuantileRule::kUpper);
}

/// Whether the stamps run as the recorder's clock does: stamps of 0 do not.
bool run_alike(std::span<const MessageTimes> scans) {
  constexpr double kShare = 0.1;
  const MessageTimes &first = scans.front(), &last = scans.back();
  const double recorded_s = seconds(last.recorded_ns - first.recorded_ns);
  return std::abs(seconds(last.stamp_ns - first.stamp_ns) - recorded_s) <= kShare * recorded_s;
}

/// Some messages of all topics of poses that change.
std::vector<MessageTimes> times_of_poses(const BagReader& bag, const Reading& asked) {
  std::set<std::string> topics;
  for (const std::string_view type : {kTfMessage, kOldTfMessage, kTransformStamped, kOdometry,
                                      kPoseStamped, kPoseWithCovarianceStamped}) {
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
      if (transforms.empty()) continue;
      poses.push_back({asked.moved_ns(transforms[0].stamp_ns), message.recorded_ns});
    }
  }
  return poses;
}

std::string range_of(std::span<const MessageTimes> messages, std::int64_t MessageTimes::*time) {
  const auto [first, last] = std::ranges::minmax(messages, {}, time);
  return fmt::format("{:.3f} to {:.3f} s", seconds(first.*time), seconds(last.*time));
}

/// A sentence on what the recorder shows of clocks that differ by less.
std::optional<std::string> doubt_about_recording(std::span<const MessageTimes> scans,
                                                 std::span<const MessageTimes> poses) {
  // A converter, which recorded nothing, takes the stamps for both.
  const auto is_converted = [](const MessageTimes& m) { return m.stamp_ns == m.recorded_ns; };
  // A simulator, whose clock begins at 0, knows a scan before its last point.
  const bool is_simulated = unit_since_1970(seconds(scans.front().stamp_ns)) != TimeUnit::kSeconds;
  if (is_simulated || std::ranges::all_of(scans, is_converted)) return std::nullopt;
  const double early_s = ahead_s(scans, true), late_s = -early_s, poses_early_s = ahead_s(poses);
  if (early_s > kMostEarly_s && early_s > poses_early_s + kMostEarly_s) {
    return fmt::format(
        "scans were recorded {:.0f} ms before their last point was measured, by their stamps: the "
        "clock of the scans is at least {:.0f} ms ahead of the recorder's{}",
        1e3 * early_s, 1e3 * early_s,
        std::abs(poses_early_s) < kMostEarly_s ? ", by which poses are stamped" : "");
  }
  if (late_s > kMostLate_s && std::abs(poses_early_s) < kMostLate_s / 4.0) {
    return fmt::format(
        "scans were recorded {:.0f} ms after their last point was measured, by their stamps, poses "
        "{:.0f} ms after theirs: the clocks of scans and poses seem to differ",
        1e3 * late_s, -1e3 * poses_early_s);
  }
  return std::nullopt;
}

}  // namespace

std::optional<ClockDoubt> doubt_about_clocks(const BagReader& bag,
                                             std::span<const MessageTimes> scans,
                                             const Reading& asked) {
  const std::vector<MessageTimes> poses = times_of_poses(bag, asked);
  if (scans.empty() || poses.empty()) return std::nullopt;
  const double apart_s = ahead_s(scans) - ahead_s(poses);
  if (std::abs(apart_s) <= kMostApart_s) {
    const auto what = doubt_about_recording(scans, poses);
    return what ? std::optional(ClockDoubt{*what, {}}) : std::nullopt;
  }
  const std::string what = fmt::format(
      "the clock of the scans is {:+.3f} s from that of the poses: scans are stamped {} and were "
      "recorded {}, poses are stamped {}; the times of recording would fit, "
      "to about the time that a scan takes",
      apart_s, range_of(scans, &MessageTimes::stamp_ns),
      range_of(scans, &MessageTimes::recorded_ns), range_of(poses, &MessageTimes::stamp_ns));
  ClockDoubt doubt{what, {}};
  // A scan is recorded after its last point.
  const double late_s = ahead_s(poses) - ahead_s(scans, true);
  if (run_alike(scans)) doubt.offset_s = mending_offset_s(asked.pose_offset_s, late_s);
  return doubt;
}

}  // namespace mosbench
