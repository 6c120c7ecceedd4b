#include "datasets/sequence/corrected_sequence.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/sequence/portable_math.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

Point moved(const Pose& pose, const Point& point) {
  const Eigen::Vector3d p = pose * Eigen::Vector3d(point.x, point.y, point.z);
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
          point.intensity};
}

constexpr std::int64_t kUsualPeriod_ns = 100'000'000;

/// `share` of a motion: translation linearly, rotation about its axis. May be negative.
Pose share_of(const Pose& motion, double share) {
  const Eigen::AngleAxisd turn(Eigen::Quaterniond(motion.linear()).normalized());
  Pose part = Pose::Identity();
  part.linear() = Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  part.translation() = share * motion.translation();
  return part;
}

constexpr std::int64_t kUsualTurn_ns = 100'000'000, kLongestTurn_ns = 1'000'000'000;
// All points of one step are moved by one pose. At 30 m/s a step is 0.3 mm long.
constexpr double kSteps = 10'000;

std::int64_t median_interval_ns(const std::vector<ScanEntry>& scans) {
  std::vector<double> intervals_ns;
  for (std::size_t k = 1; k < scans.size(); ++k) {
    if (!scans[k].stamp_ns || !scans[k - 1].stamp_ns) return kUsualTurn_ns;
    intervals_ns.push_back(static_cast<double>(*scans[k].stamp_ns - *scans[k - 1].stamp_ns));
  }
  if (intervals_ns.empty()) return kUsualTurn_ns;
  const double median_ns = quantile(std::move(intervals_ns), 0.5, QuantileRule::kUpper);
  const bool is_turn = median_ns > 0.0 && median_ns <= kLongestTurn_ns;
  return is_turn ? static_cast<std::int64_t>(median_ns) : kUsualTurn_ns;
}

/// Moves the origins of the sensors other than the first to where these were when they measured
/// their first points. Returns false where a pose is missing.
bool move_origins(Frame& frame, std::int64_t stamp_ns, const PoseAt& pose_at) {
  std::vector<Eigen::Vector3d>& origins = frame.origins.positions_m;
  for (std::size_t sensor = 1; sensor < origins.size(); ++sensor) {
    const auto first = std::ranges::find(frame.origins.of_point, sensor);
    if (first == frame.origins.of_point.end()) continue;
    const auto at = static_cast<std::size_t>(first - frame.origins.of_point.begin());
    const auto here = pose_at(stamp_ns), there = pose_at(stamp_ns + frame.point_times_ns[at]);
    if (!here || !there) return false;
    origins[sensor] = here->inverse() * (*there * origins[sensor]);
  }
  return true;
}

/// A sequence whose frames are changed after they are read.
class ChangedSequence : public SequenceAround {
 public:
  using Change = std::function<void(std::size_t scan_index, Frame& frame)>;
  ChangedSequence(std::unique_ptr<Sequence> inner, Change change)
      : SequenceAround(std::move(inner)), change_(std::move(change)) {}

  using Sequence::mutable_recording;
  using SequenceAround::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    SequenceAround::read(scan_index, frame);
    change_(scan_index, frame);
  }

 private:
  Change change_;
};

}  // namespace

bool undistort(std::span<Point> points, std::span<const std::int64_t> times_ns,
               std::int64_t stamp_ns, std::int64_t reference_ns, const PoseAt& map_from_sensor) {
  const std::optional<Pose> reference = map_from_sensor(reference_ns);
  if (!reference) return false;
  const Pose reference_from_map = reference->inverse();
  // All points of a column of a spinning sensor have the same time.
  std::unordered_map<std::int64_t, Pose> reference_from_time;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int64_t at_ns = stamp_ns + times_ns[i];
    // Moved, a missing return would be one near the sensor.
    if (at_ns == reference_ns || !is_return(points[i])) continue;
    auto known = reference_from_time.find(at_ns);
    if (known == reference_from_time.end()) {
      const std::optional<Pose> pose = map_from_sensor(at_ns);
      if (!pose) return false;
      known = reference_from_time.emplace(at_ns, reference_from_map * *pose).first;
    }
    points[i] = moved(known->second, points[i]);
  }
  return true;
}

ScanDeskewer::ScanDeskewer(Deskew by, const std::vector<ScanEntry>& scans) : by_(by) {
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (const ScanEntry& scan : scans) {
    poses_.push_back(scan.map_from_sensor);
    stamps_ns_.push_back(
        scan.stamp_ns.value_or(kUsualPeriod_ns * static_cast<std::int64_t>(stamps_ns_.size())));
    stamped.emplace_back(stamps_ns_.back(), poses_.back());
  }
  tracks_ = ScanTracks(stamped);
}

/// The motion since the scan before; in the first scan that to the next.
std::optional<ScanDeskewer::Motion> ScanDeskewer::motion_at(std::size_t scan_index) const {
  if (poses_.size() < 2) return std::nullopt;
  const std::size_t to = scan_index == 0 ? 1 : scan_index;
  const std::int64_t period_ns = stamps_ns_[to] - stamps_ns_[to - 1];
  if (period_ns <= 0) return std::nullopt;
  return Motion{poses_[scan_index], poses_[to - 1].inverse() * poses_[to], period_ns};
}

bool ScanDeskewer::move_by(Deskew by, std::size_t scan_index, Frame& frame) const {
  const std::int64_t stamp_ns = stamps_ns_[scan_index];
  const auto moves = [&](const PoseAt& pose_at) {
    return undistort(frame.points, frame.point_times_ns, stamp_ns, stamp_ns, pose_at) &&
           move_origins(frame, stamp_ns, pose_at);
  };
  if (by == Deskew::kPoses) {
    return moves([&](std::int64_t at_ns) { return tracks_.around(scan_index).at(at_ns); });
  }
  const std::optional<Motion> motion = motion_at(scan_index);
  return motion && moves([&](std::int64_t at_ns) {
           const double periods =
               static_cast<double>(at_ns - stamp_ns) / static_cast<double>(motion->period_ns);
           return std::optional<Pose>(motion->map_from_sensor * share_of(motion->to_next, periods));
         });
}

void ScanDeskewer::apply(std::size_t scan_index, Frame& frame) const {
  const bool is_rig = !frame.origins.empty();
  if ((by_ == Deskew::kNone && !is_rig) || frame.point_times_ns.empty() || poses_.empty()) return;
  const std::vector<Point> as_measured = frame.points;
  bool is_moved = move_by(by_ == Deskew::kNone ? Deskew::kPoses : by_, scan_index, frame);
  if (!is_moved) frame.points = as_measured;
  if (!is_moved && is_rig) is_moved = move_by(Deskew::kVelocity, scan_index, frame);
  if (!is_moved) {
    frame.points = as_measured;
    return;
  }
  frame.point_times_ns.clear();
}

PosedSequence::PosedSequence(std::unique_ptr<Sequence> inner, PosesDone how, Deskew deskew,
                             bool states_deskew)
    : SequenceAround(std::move(inner)), deskew_(deskew) {
  ReadingDone& reading = mutable_recording().reading;
  reading.poses = std::move(how);
  if (states_deskew) reading.deskew = deskew;
}

void PosedSequence::set_poses(const std::vector<Pose>& map_from_sensor, std::string remark) {
  if (map_from_sensor.size() != size()) throw std::invalid_argument("one pose per scan is needed");
  for (std::size_t k = 0; k < size(); ++k) {
    mutable_recording().scans[k].map_from_sensor = map_from_sensor[k];
  }
  deskewer_ = ScanDeskewer(deskew_, recording().scans);
  if (!remark.empty()) mutable_recording().remarks.push_back(std::move(remark));
}

void PosedSequence::read(std::size_t scan_index, Frame& frame) const {
  SequenceAround::read(scan_index, frame);
  frame.map_from_sensor = map_from_sensor(scan_index);
  deskewer_.apply(scan_index, frame);
}

std::vector<std::int64_t> azimuth_times_ns(std::span<const Point> points, std::int64_t turn_ns) {
  std::vector<std::int64_t> times_ns;
  times_ns.reserve(points.size());
  for (const Point& point : points) {
    const double turns = -std::atan2(static_cast<double>(point.y), static_cast<double>(point.x)) /
                         (2 * std::numbers::pi);
    const double step = std::isfinite(turns) ? std::round(kSteps * turns) : 0;
    times_ns.push_back(std::llround(step / kSteps * static_cast<double>(turn_ns)));
  }
  return times_ns;
}

Point raised_by_hdl64_correction(const Point& point) {
  constexpr double kRadPerDeg = 3.14159265358979323846 / 180.0;
  static const SinCos raise = sin_cos(0.205 * kRadPerDeg);
  const double x = point.x, y = point.y, z = point.z;
  const double across_m = std::sqrt(x * x + y * y);
  if (across_m == 0.0) return point;
  const double scale = (across_m * raise.cos - z * raise.sin) / across_m;
  return {static_cast<float>(x * scale), static_cast<float>(y * scale),
          static_cast<float>(z * raise.cos + across_m * raise.sin), point.intensity};
}

std::unique_ptr<Sequence> deskewed(std::unique_ptr<Sequence> inner, Deskew by) {
  const ScanDeskewer deskewer(by, inner->recording().scans);
  auto changed = std::make_unique<ChangedSequence>(
      std::move(inner),
      [deskewer](std::size_t scan_index, Frame& frame) { deskewer.apply(scan_index, frame); });
  changed->mutable_recording().reading.deskew = by;
  return changed;
}

std::unique_ptr<Sequence> with_azimuth_times(std::unique_ptr<Sequence> inner) {
  const std::int64_t turn_ns = median_interval_ns(inner->recording().scans);
  auto changed =
      std::make_unique<ChangedSequence>(std::move(inner), [turn_ns](std::size_t, Frame& frame) {
        frame.point_times_ns = azimuth_times_ns(frame.points, turn_ns);
      });
  const std::string how =
      fmt::format("by azimuth, a turn in {:g} s", static_cast<double>(turn_ns) * 1e-9);
  changed->mutable_recording().reading.point_times = how;
  changed->mutable_recording().remarks.push_back("times of points " + how);
  return changed;
}

std::unique_ptr<Sequence> with_hdl64_correction(std::unique_ptr<Sequence> inner) {
  auto changed = std::make_unique<ChangedSequence>(std::move(inner), [](std::size_t, Frame& frame) {
    for (Point& point : frame.points) point = raised_by_hdl64_correction(point);
  });
  changed->mutable_recording().reading.hdl64_correction = true;
  return changed;
}

}  // namespace mosbench
