#include "datasets/sequence/kept_scans.hpp"

#include <utility>

namespace mosbench {
namespace {

std::size_t bytes_of(const PointMotions& motions) {
  return motions.velocities_m_s.size() * sizeof(Eigen::Vector3f) + motions.classes.size() +
         motions.on_ground.size() + motions.evaluated.size();
}

std::size_t bytes_of(const Frame& frame) {
  return frame.points.size() * sizeof(Point) + frame.origins.of_point.size() +
         frame.point_times_ns.size() * sizeof(std::int64_t) +
         frame.radial_velocity_m_s.size() * sizeof(float) +
         (frame.motions ? bytes_of(*frame.motions) : 0) +
         (frame.truth ? frame.truth->size() * sizeof(std::uint32_t) : 0);
}

}  // namespace

template <typename Value>
std::span<const Value> KeptScans::copy(const std::vector<Value>& values) {
  auto* place =
      static_cast<Value*>(memory_.allocate(values.size() * sizeof(Value), alignof(Value)));
  std::uninitialized_copy(values.begin(), values.end(), place);
  return {place, values.size()};
}

bool KeptScans::find(std::size_t scan_index, Frame& frame) const {
  const std::lock_guard lock(mutex_);
  const auto found = scans_.find(scan_index);
  if (found == scans_.end()) return false;
  const Scan& scan = found->second;
  frame.stem = scan.small.stem;
  frame.map_from_sensor = scan.small.map_from_sensor;
  frame.stamp_ns = scan.small.stamp_ns;
  frame.origins = scan.small.origins;
  frame.motions = scan.small.motions;
  frame.radial_velocity_m_s = scan.small.radial_velocity_m_s;
  frame.points.assign(scan.points.begin(), scan.points.end());
  frame.point_times_ns.assign(scan.point_times_ns.begin(), scan.point_times_ns.end());
  frame.truth.reset();
  if (scan.truth) frame.truth.emplace(scan.truth->begin(), scan.truth->end());
  return true;
}

void KeptScans::keep(std::size_t scan_index, const Frame& frame) {
  const std::lock_guard lock(mutex_);
  const std::size_t bytes = bytes_of(frame);
  if (bytes_ + bytes > most_bytes_ || scans_.contains(scan_index)) return;
  // Names all members, so that a new one is not forgotten here and in `find`.
  const auto& [stem, points, map_from_sensor, stamp_ns, point_times_ns, origins, motions,
               radial_velocity_m_s, truth] = frame;
  Scan& scan = scans_[scan_index];
  scan.small.stem = stem;
  scan.small.map_from_sensor = map_from_sensor;
  scan.small.stamp_ns = stamp_ns;
  scan.small.origins = origins;
  scan.small.motions = motions;
  scan.small.radial_velocity_m_s = radial_velocity_m_s;
  scan.points = copy(points);
  scan.point_times_ns = copy(point_times_ns);
  if (truth) scan.truth = copy(*truth);
  bytes_ += bytes;
}

void KeptScans::clear() {
  const std::lock_guard lock(mutex_);
  scans_.clear();
  memory_.release();
  bytes_ = 0;
}

std::size_t KeptScans::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

KeptSequence::KeptSequence(std::unique_ptr<Sequence> inner, std::shared_ptr<KeptScans> scans)
    : SequenceAround(std::move(inner)), scans_(std::move(scans)) {}

void KeptSequence::read(std::size_t scan_index, Frame& frame) const {
  if (scans_->find(scan_index, frame)) return;
  SequenceAround::read(scan_index, frame);
  scans_->keep(scan_index, frame);
}

}  // namespace mosbench
