#include "datasets/sequence/scan_deskewer.hpp"

#include <Eigen/Geometry>
#include <utility>

#include "datasets/sequence/undistort.hpp"

namespace mosbench {
namespace {

constexpr std::int64_t kUsualPeriod_ns = 100'000'000;

/// `share` of a motion: translation linearly, rotation about its axis. May be negative.
Pose share_of(const Pose& motion, double share) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(motion.linear()).normalized());
  Pose part = Pose::Identity();
  part.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  part.translation() = share * motion.translation();
  return part;
}

}  // namespace

ScanDeskewer::ScanDeskewer(Deskew by, const std::vector<ScanEntry>& scans) : by_(by) {
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (const ScanEntry& scan : scans) {
    poses_.push_back(scan.map_from_sensor);
    stamps_ns_.push_back(
        scan.stamp_ns.value_or(kUsualPeriod_ns * static_cast<std::int64_t>(stamps_ns_.size())));
    stamped.emplace_back(stamps_ns_.back(), poses_.back());
  }
  track_ = PoseTrack(std::move(stamped));
}

/// The motion since the scan before; in the first scan that to the next.
std::optional<ScanDeskewer::Motion> ScanDeskewer::motion_at(std::size_t scan_index) const {
  if (poses_.size() < 2) return std::nullopt;
  const std::size_t to = scan_index == 0 ? 1 : scan_index;
  const std::int64_t period_ns = stamps_ns_[to] - stamps_ns_[to - 1];
  if (period_ns <= 0) return std::nullopt;
  return Motion{poses_[scan_index], poses_[to - 1].inverse() * poses_[to], period_ns};
}

bool ScanDeskewer::move_by(std::size_t scan_index, Frame& frame) const {
  const std::int64_t stamp_ns = stamps_ns_[scan_index];
  const auto moves = [&](const PoseAt& pose_at) {
    return undistort(frame.points, frame.point_times_ns, stamp_ns, stamp_ns, pose_at);
  };
  if (by_ == Deskew::kPoses) {
    return moves([&](std::int64_t at_ns) { return track_.at(at_ns); });
  }
  const std::optional<Motion> motion = motion_at(scan_index);
  return motion && moves([&](std::int64_t at_ns) {
           const double periods =
               static_cast<double>(at_ns - stamp_ns) / static_cast<double>(motion->period_ns);
           return std::optional<Pose>(motion->map_from_sensor * share_of(motion->to_next, periods));
         });
}

void ScanDeskewer::apply(std::size_t scan_index, Frame& frame) const {
  if (by_ == Deskew::kNone || frame.point_times_ns.empty()) return;
  std::vector<Point> as_measured = frame.points;
  if (!move_by(scan_index, frame)) {
    frame.points = std::move(as_measured);
    return;
  }
  frame.point_times_ns.clear();
}

DeskewedSequence::DeskewedSequence(std::unique_ptr<Sequence> inner, Deskew by)
    : SequenceAround(std::move(inner)), deskewer_(by, recording().scans) {
  mutable_recording().reading.deskew = by;
}

void DeskewedSequence::read(std::size_t scan_index, Frame& frame) const {
  SequenceAround::read(scan_index, frame);
  deskewer_.apply(scan_index, frame);
}

}  // namespace mosbench
