#include "datasets/rosbag/bag_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/rosbag/bag_clocks.hpp"
#include "datasets/rosbag/bag_reader.hpp"
#include "datasets/rosbag/bag_topics.hpp"
#include "datasets/rosbag/bag_turns.hpp"
#include "datasets/sequence/pose_clock.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/stamps.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Enough bytes of a message for all that precedes the points; a field takes some 20 bytes.
constexpr std::size_t kHeadBytes = 4096;
/// No scan takes longer.
constexpr std::int64_t kLongestScanNs = 1'000'000'000;

/// The mark that `convert` left in a bag.
DataMark mark_inside(const BagReader& bag) {
  const std::vector<BagMessage> messages = bag.messages(kMarkTopic);
  if (messages.empty()) return {};
  const BagMessage& first = messages.front();
  return parse_mark(parse_string(bag.read(first), bag.format_of(first), bag.path()), bag.path());
}

}  // namespace

std::optional<std::filesystem::path> bag_of(const std::filesystem::path& folder) {
  const auto bags = list_by_stem(folder, {".bag"});
  if (bags.empty()) return std::nullopt;
  if (bags.size() > 1) {
    throw DataError(folder, fmt::format("holds {} bags", bags.size()), "one per sequence");
  }
  return bags.front().file;
}

BagSequence::BagSequence(std::string name, const std::filesystem::path& bag, const Reading& asked)
    : BagSequence(std::move(name), open_bag(bag), asked) {}

BagSequence::BagSequence(std::string name, std::unique_ptr<const BagReader> bag,
                         const Reading& asked)
    : bag_(std::move(bag)),
      undistorts_(asked.undistorts()),
      keeps_times_(asked.is_by_odometry() || asked.deskew == Deskew::kVelocity || asked.is_rig()),
      by_azimuth_(asked.point_times == PointTimes::kAzimuth) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), bag_->path().parent_path());
  recording.files = bag_->files();
  recording.remarks = bag_->remarks();
  recording.doubts = bag_->doubts();
  recording.mark = mark_inside(*bag_);
  const std::string topic = cloud_topic(*bag_, asked.topic);
  list_scans(topic);
  expect_one_frame(topic);
  judge_times(asked);
  recording.reading.scan_files =
      fmt::format("{}, topic {}", bag_->path().filename().string(), topic);
  const auto turns = doubt_about_turns(
      scans_.size(), [this](std::size_t k) { return stored_cloud(scans_[k], false).points; });
  if (turns) recording.doubts.push_back(fmt::format("topic {}: {}", topic, *turns));
  asked.has_own_poses() ? open_transforms(asked) : open_pose_file(asked);
  state_undistortion();
  if (const auto clocks = doubt_about_clock(*this, pose_at_)) add_clock_doubt(recording, *clocks);
}

PoseAt BagSequence::pose_at(std::size_t scan_index) const {
  // Where stamps go back, a time tells no pose.
  if (pose_at_ && tracks_.breaks() == 0) return pose_at_;
  return
      [&track = tracks_.around(scan_index)](std::int64_t stamp_ns) { return track.at(stamp_ns); };
}

TimedCloud BagSequence::stored_cloud(const Scan& scan, bool timed) const {
  return parse_cloud(bag_->read(scan.message), bag_->path(), bag_->format_of(scan.message), timed);
}

BagSequence::MovingCloud BagSequence::cloud_of(const Scan& scan) const {
  MovingCloud cloud{stored_cloud(scan, clock_.knows_unit()), {}};
  cloud.times_ns = clock_.after_stamp_ns({std::move(cloud.times), cloud.stamp_ns});
  settle_times(cloud.times_ns, 0);
  return cloud;
}

void BagSequence::judge_times(const Reading& asked) {
  if (!undistorts_ || std::ranges::none_of(scans_, &Scan::timed)) return;
  Recording as_listed;
  for (const Scan& scan : scans_) as_listed.scans.emplace_back().stamp_ns = scan.stamp_ns;
  clock_ = judged_clock(
      as_listed, [&](std::size_t k) { return stored_cloud(scans_[k], true).times; },
      told_unit(asked));
  Recording& recording = mutable_recording();
  recording.reading.point_times = as_listed.reading.point_times;
  for (const auto said : {&Recording::remarks, &Recording::doubts}) {
    (recording.*said)
        .insert((recording.*said).end(), (as_listed.*said).begin(), (as_listed.*said).end());
  }
}

void BagSequence::enter_scans() {
  for (const Scan& scan : scans_) {
    ScanEntry& entry = mutable_recording().scans.emplace_back();
    entry.has_truth = scan.labelled;
    entry.stem = fmt::format("{:06}", scan.number);
    entry.stamp_ns = scan.stamp_ns;
    entry.points = scan.points;
    entry.number = scan.number;
  }
}

void BagSequence::list_scans(const std::string& topic) {
  for (const BagMessage& message : bag_->messages(topic)) {
    const CloudHead head =
        parse_cloud_head(bag_->read(message, kHeadBytes), bag_->path(), bag_->format_of(message));
    scans_.push_back({message, scans_.size(), head.stamp_ns, head.points(),
                      has_times(head) && !by_azimuth_, find_field(head, "label") != nullptr,
                      head.frame});
  }
  if (scans_.empty()) {
    throw DataError(bag_->path(), "topic " + topic + " holds no message", "one per scan");
  }
}

/// Throws DataError for scans of two sensors. Those without a frame are told nothing of.
void BagSequence::expect_one_frame(const std::string& topic) const {
  std::string frame;
  for (const Scan& scan : scans_) {
    if (frame.empty()) frame = scan.frame;
    if (scan.frame.empty() || scan.frame == frame) continue;
    throw DataError(
        bag_->path(),
        fmt::format("topic {} has scans in the frames {} and {}", topic, frame, scan.frame),
        "one sensor");
  }
}

void BagSequence::open_pose_file(const Reading& asked) {
  enter_scans();
  const std::vector<Scan> all = std::exchange(scans_, {});
  for (const std::size_t k :
       place_scans(bag_->path().parent_path(), "poses.txt", asked, mutable_recording())) {
    scans_.push_back(all[k]);
  }
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    stamped.emplace_back(scans_[k].stamp_ns, map_from_sensor(k));
  }
  tracks_ = ScanTracks(stamped);
  pose_at_ = stamped_poses(bag_->path().parent_path(), "poses.txt", asked);
  doubt_about_raw_scans();
  if (tracks_.breaks() == 0) return;
  mutable_recording().doubts.push_back(fmt::format(
      "the stamps of {} of {} are not later than the one before: scans before these are "
      "not undistorted",
      tracks_.breaks(), counted(scans_.size(), "scan")));
}

void BagSequence::open_transforms(const Reading& asked) {
  const auto named = std::ranges::find_if(scans_, [](const Scan& s) { return !s.frame.empty(); });
  const std::string frame = named == scans_.end() ? "" : named->frame;
  const std::size_t all = scans_.size();
  std::erase_if(scans_, [&](const Scan& scan) { return scan.frame != frame; });
  Recording& recording = mutable_recording();
  if (scans_.size() < all) {
    recording.doubts.push_back(fmt::format("{} of {} are left out: they name no frame",
                                           all - scans_.size(), counted(all, "scan")));
  }
  BagTransforms transforms = bag_transforms(*bag_, asked, frame);
  recording.reading.poses.source = transforms.source;
  recording.reading.poses.offset_s = asked.pose_offset_s;
  state_pose_origin(bag_->files().front(), recording.reading.poses, recording.doubts);
  recording.remarks.push_back("poses from the bag: " + transforms.source);
  std::ranges::move(transforms.remarks, std::back_inserter(recording.remarks));
  std::ranges::move(transforms.doubts, std::back_inserter(recording.doubts));
  transforms_ = std::move(transforms.map_from_sensor);
  pose_at_ = [this](std::int64_t stamp_ns) { return transforms_->at(stamp_ns); };
  const std::int64_t last_ns = usual_times_ns().second;
  std::vector<MessageTimes> times;
  for (const Scan& scan : scans_) {
    times.push_back({scan.stamp_ns, scan.message.recorded_ns, last_ns});
  }
  const auto clocks = doubt_about_clocks(*bag_, times, asked);
  if (clocks) add_clock_doubt(recording, *clocks);
  leave_out_uncovered(clocks ? to_string(*clocks) : "");
  enter_scans();
  for (ScanEntry& scan : recording.scans) scan.map_from_sensor = *transforms_->at(*scan.stamp_ns);
}

std::pair<std::int64_t, std::int64_t> BagSequence::usual_times_ns() const {
  constexpr std::size_t kLooked = 9;
  std::vector<double> firsts_ns, lasts_ns;
  for (std::size_t i = 0; i < kLooked; ++i) {
    const MovingCloud cloud = cloud_of(scans_[i * scans_.size() / kLooked]);
    if (cloud.times_ns.empty()) continue;
    const auto [first, last] = std::ranges::minmax(cloud.times_ns);
    firsts_ns.push_back(static_cast<double>(first));
    lasts_ns.push_back(static_cast<double>(last));
  }
  if (lasts_ns.empty()) return {0, 0};
  const auto usual = [](std::vector<double> times) {
    return std::llround(quantile(std::move(times), 0.5, QuantileRule::kUpper));
  };
  return {usual(std::move(firsts_ns)), usual(std::move(lasts_ns))};
}

void BagSequence::doubt_about_raw_scans() {
  if (!undistorts_ || keeps_times_) return;
  const auto [first_ns, last_ns] = usual_times_ns();
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    raw_scans_ += !has_poses(k, scans_[k].stamp_ns + first_ns, scans_[k].stamp_ns + last_ns);
  }
  // One is at the end of every way of poses.
  if (raw_scans_ <= 1 + tracks_.breaks()) return;
  mutable_recording().doubts.push_back(
      fmt::format("{} of {} are not undistorted: the poses do not cover the times of their points",
                  raw_scans_, counted(scans_.size(), "scan")));
}

bool BagSequence::has_poses(std::size_t scan_index, std::int64_t from_ns,
                            std::int64_t to_ns) const {
  const PoseAt poses = pose_at(scan_index);
  return poses(from_ns) && poses(to_ns);
}

bool BagSequence::covered(const Scan& scan) const {
  if (!transforms_->at(scan.stamp_ns)) return false;
  if (!undistorts_ || !scan.timed) return true;
  // Points may also have been measured before the stamp.
  if (transforms_->covers(scan.stamp_ns - kLongestScanNs, scan.stamp_ns + kLongestScanNs)) {
    return true;
  }
  const MovingCloud cloud = cloud_of(scan);
  return cloud.times_ns.empty() ||
         transforms_->covers(cloud.stamp_ns + std::ranges::min(cloud.times_ns),
                             cloud.stamp_ns + std::ranges::max(cloud.times_ns));
}

void BagSequence::leave_out_uncovered(const std::string& clocks) {
  const std::vector<Scan> all = scans_;
  std::erase_if(scans_, [this](const Scan& scan) { return !covered(scan); });
  if (scans_.size() == all.size()) return;
  std::string why;
  for (std::size_t k = 0; k < all.size() && why.empty(); ++k) {
    why = transforms_->lacks(all[k].stamp_ns);
  }
  if (!why.empty()) why = "; " + why;
  if (are_too_few(scans_.size(), all.size())) {
    throw DataError(
        bag_->path(),
        fmt::format("transforms cover {} of {}, from {:.3f} to {:.3f} s{}{}{}", scans_.size(),
                    counted(all.size(), "scan"), seconds_of(all.front().stamp_ns),
                    seconds_of(all.back().stamp_ns), why, clocks.empty() ? "" : "; ", clocks),
        fmt::format("poses while the scans are taken, another frame in {}, a longer {}, or {}",
                    option("map_frame"), option("max_pose_gap_s"), option("poses", "FILE")));
  }
  mutable_recording().doubts.push_back(fmt::format(
      "{} of {} are left out: no transform covers them{}{}", all.size() - scans_.size(),
      counted(all.size(), "scan"), undistorts_ ? " from first to last point" : "", why));
}

void BagSequence::state_undistortion() {
  const bool timed = scans_.front().timed;
  const BagUndistortion how = by_azimuth_            ? BagUndistortion::kOtherTimes
                              : !timed               ? BagUndistortion::kNoTimes
                              : !undistorts_         ? BagUndistortion::kAsTold
                              : !clock_.knows_unit() ? BagUndistortion::kNoUnit
                              : raw_scans_ > 0       ? BagUndistortion::kButLast
                                                     : BagUndistortion::kAll;
  mutable_recording().reading.undistortion = how;
  mutable_recording().remarks.push_back(fmt::format("undistortion: {}", to_string(how)));
}

void BagSequence::read(std::size_t scan_index, Frame& frame) const {
  MovingCloud cloud = cloud_of(scans_.at(scan_index));
  const std::int64_t stamp_ns = cloud.stamp_ns;
  describe(scan_index, frame);
  frame.points = std::move(cloud.points);
  frame.truth = std::move(cloud.labels);
  if (!undistorts_ || cloud.times_ns.empty()) return;
  if (keeps_times_) {
    frame.point_times_ns = std::move(cloud.times_ns);
    return;
  }
  const auto [first_ns, last_ns] = std::ranges::minmax(cloud.times_ns);
  if (!has_poses(scan_index, stamp_ns + first_ns, stamp_ns + last_ns)) return;
  undistort(frame.points, cloud.times_ns, stamp_ns, stamp_ns, pose_at(scan_index));
}

std::vector<std::uint32_t> BagSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  return stored_cloud(scans_.at(scan_index), false).labels.value();
}

}  // namespace mosbench
