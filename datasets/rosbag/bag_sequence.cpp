#include "datasets/rosbag/bag_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/rosbag/bag_topics.hpp"
#include "datasets/rosbag/open_bag.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/pose_track.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// Enough bytes of a message for all that precedes the points; a field takes some 20 bytes.
constexpr std::size_t kHeadBytes = 4096;
/// Scans last 0.1 s; a longer time is not measured from the scan's stamp.
constexpr std::int64_t kLongestScanNs = 1'000'000'000;

std::int64_t reference_ns(const TimedCloud& cloud) {
  return cloud.stamp_ns + (cloud.times_ns.empty() ? 0 : cloud.times_ns.front());
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

BagSequence::BagSequence(std::string name, const std::filesystem::path& bag,
                         const ReadingOptions& options)
    : bag_(open_bag(bag)),
      undistorts_(options.undistorts()),
      keeps_times_(options.poses_by_odometry || options.deskew == Deskew::kVelocity),
      by_azimuth_(options.point_times == PointTimes::kAzimuth) {
  if (options.point_times == PointTimes::kColumn) {
    throw UsageError("--point-times column: " + bag.string() + " is a bag, expected .bin files");
  }
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), bag.parent_path());
  recording.files = bag_->files();
  recording.remarks = bag_->remarks();
  const std::string topic = cloud_topic(*bag_, options.topic);
  list_scans(topic);
  recording.reading.emplace_back("scan_files",
                                 fmt::format("{}, topic {}", bag.filename().string(), topic));
  options.poses || options.poses_by_odometry ? open_pose_file(options) : open_transforms(options);
  state_undistortion();
  enter_scans();
}

CloudHead BagSequence::head_of(const BagMessage& message) const {
  const MessageFormat format = bag_->format_of(message);
  return parse_cloud_head(bag_->read(message, kHeadBytes), bag_->path(), format);
}

TimedCloud BagSequence::cloud_of(const Scan& scan) const {
  const MessageFormat format = bag_->format_of(scan.message);
  return parse_cloud(bag_->read(scan.message), bag_->path(), format);
}

ScanEntry BagSequence::entry_of(const Scan& scan) {
  ScanEntry entry;
  entry.stem = fmt::format("{:06}", scan.number);
  entry.stamp_ns = scan.stamp_ns;
  entry.points = scan.points;
  return entry;
}

void BagSequence::enter_scans() {
  for (const Scan& scan : scans_) {
    ScanEntry& entry = mutable_recording().scans.emplace_back(entry_of(scan));
    entry.map_from_sensor = *pose_at_(scan.stamp_ns);
    entry.has_truth = scan.labelled;
  }
}

void BagSequence::list_scans(const std::string& topic) {
  for (const BagMessage& message : bag_->messages(topic)) {
    const CloudHead head = head_of(message);
    scans_.push_back({message, scans_.size(), head.stamp_ns, head.points(),
                      has_times(head) && !by_azimuth_, find_field(head, "label") != nullptr,
                      head.frame});
  }
  if (scans_.empty()) {
    throw DataError(bag_->path(), "topic " + topic + " holds no message", "one per scan");
  }
  for (const Scan& scan : scans_) {
    if (scan.frame == scans_.front().frame) continue;
    throw DataError(bag_->path(),
                    fmt::format("topic {} has scans in the frames {} and {}", topic,
                                scans_.front().frame, scan.frame),
                    "one sensor");
  }
}

void BagSequence::open_pose_file(const ReadingOptions& options) {
  std::vector<std::int64_t> stamps_ns;
  for (const Scan& scan : scans_) stamps_ns.push_back(scan.stamp_ns);
  const SensorPoses poses = read_sensor_poses(bag_->path().parent_path(), "poses.txt", options,
                                              {scans_.size(), stamps_ns});
  std::vector<Scan> scans = std::exchange(scans_, {});
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (std::ranges::binary_search(poses.unknown, i)) {
      mutable_recording().left_out.push_back(entry_of(scans[i]));
      continue;
    }
    stamped.emplace_back(stamps_ns[i], poses.map_from_sensor[i]);
    scans_.push_back(std::move(scans[i]));
  }
  pose_at_ = [track = PoseTrack(std::move(stamped))](std::int64_t stamp_ns) {
    return track.at(stamp_ns);
  };
  leaves_last_ = true;
  add_statements(poses, mutable_recording());
}

void BagSequence::open_transforms(const ReadingOptions& options) {
  BagTransforms transforms =
      bag_transforms(*bag_, options.map_frame, scans_.front().frame, options.pose_topic);
  mutable_recording().reading.emplace_back("poses", transforms.source);
  state_pose_origin(bag_->files().front(), mutable_recording().reading,
                    mutable_recording().remarks);
  mutable_recording().remarks.push_back("poses from the bag: " + transforms.source);
  pose_at_ = [chain = std::move(transforms.map_from_sensor)](std::int64_t stamp_ns) {
    return chain.at(stamp_ns);
  };
  leave_out_uncovered();
}

bool BagSequence::covered(const Scan& scan) const {
  if (!pose_at_(scan.stamp_ns)) return false;
  if (!undistorts_ || !scan.timed) return true;
  // Points may also have been measured before the stamp.
  if (pose_at_(scan.stamp_ns - kLongestScanNs) && pose_at_(scan.stamp_ns + kLongestScanNs)) {
    return true;
  }
  const TimedCloud cloud = cloud_of(scan);
  check_times(scan, cloud);
  return cloud.times_ns.empty() || (pose_at_(cloud.stamp_ns + std::ranges::max(cloud.times_ns)) &&
                                    pose_at_(cloud.stamp_ns + std::ranges::min(cloud.times_ns)));
}

void BagSequence::leave_out_uncovered() {
  const std::size_t all = scans_.size();
  std::erase_if(scans_, [this](const Scan& scan) { return !covered(scan); });
  if (scans_.empty()) {
    throw DataError(bag_->path(), "no transform covers any of its " + counted(all, "scan"),
                    "poses while the scans are taken, or --poses FILE");
  }
  if (scans_.size() == all) return;
  mutable_recording().remarks.push_back(
      fmt::format("{} of {} are left out: no transform covers them{}", all - scans_.size(),
                  counted(all, "scan"), undistorts_ ? " from first to last point" : ""));
}

void BagSequence::state_undistortion() {
  const bool timed = scans_.front().timed;
  const std::string how = by_azimuth_    ? "not by the points' times"
                          : !timed       ? "none, the points have no times"
                          : !undistorts_ ? "none, as told"
                          : leaves_last_ ? "by the points' times, the last scan not"
                                         : "by the points' times";
  mutable_recording().reading.emplace_back("undistortion", how);
  mutable_recording().remarks.push_back("undistortion: " + how);
}

void BagSequence::check_times(const Scan& scan, const TimedCloud& cloud) const {
  for (const std::int64_t time_ns : cloud.times_ns) {
    if (time_ns >= -kLongestScanNs && time_ns <= kLongestScanNs) continue;
    throw DataError(bag_->path(), scan.number,
                    fmt::format("a point was measured {} ns after the scan's stamp", time_ns),
                    "times within a second of it");
  }
}

void BagSequence::read(std::size_t scan_index, Frame& frame) const {
  const Scan& scan = scans_.at(scan_index);
  TimedCloud cloud = cloud_of(scan);
  if (by_azimuth_) cloud.times_ns.clear();
  check_times(scan, cloud);
  const bool last = leaves_last_ && scan_index + 1 == scans_.size();
  const bool moves = undistorts_ && !keeps_times_ && !cloud.times_ns.empty() && !last;
  const std::int64_t at_ns = moves && !leaves_last_ ? reference_ns(cloud) : cloud.stamp_ns;
  const auto pose = pose_at_(at_ns);
  if (!pose ||
      (moves && !undistort(cloud.points, cloud.times_ns, cloud.stamp_ns, at_ns, pose_at_))) {
    throw DataError(bag_->path(), scan.number, "no pose covers the scan",
                    "poses while it was taken");
  }
  describe(scan_index, frame);
  frame.points = std::move(cloud.points);
  frame.map_from_sensor = *pose;
  if (undistorts_ && keeps_times_) frame.point_times_ns = std::move(cloud.times_ns);
  frame.truth = std::move(cloud.labels);
}

std::vector<std::uint32_t> BagSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  return cloud_of(scans_.at(scan_index)).labels.value();
}

}  // namespace mosbench
