#include "datasets/sequence/posed_sequence.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "datasets/sequence/undistort.hpp"

namespace mosbench {

PosedSequence::PosedSequence(std::unique_ptr<Sequence> inner, const ReadingStatement& how)
    : SequenceAround(std::move(inner)) {
  ReadingStatement& reading = mutable_recording().reading;
  std::erase_if(reading, [](const auto& statement) { return statement.first.starts_with("pose"); });
  reading.insert(reading.end(), how.begin(), how.end());
}

void PosedSequence::set_poses(const std::vector<Pose>& map_from_sensor, std::string remark) {
  if (map_from_sensor.size() != size()) throw std::invalid_argument("one pose per scan is needed");
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (std::size_t k = 0; k < size(); ++k) {
    mutable_recording().scans[k].map_from_sensor = map_from_sensor[k];
    if (const auto stamp = stamp_ns(k)) stamped.emplace_back(*stamp, map_from_sensor[k]);
  }
  track_ = PoseTrack(std::move(stamped));
  mutable_recording().remarks.push_back(std::move(remark));
}

void PosedSequence::read(std::size_t scan_index, Frame& frame) const {
  SequenceAround::read(scan_index, frame);
  frame.map_from_sensor = map_from_sensor(scan_index);
  const bool timed = !frame.point_times_ns.empty() && frame.stamp_ns && !track_.empty();
  if (!timed || scan_index + 1 == size()) return;
  // Times before the first scan or after the last have no pose: such a scan stays as it is.
  std::vector<Point> points = frame.points;
  if (undistort(points, frame.point_times_ns, *frame.stamp_ns, *frame.stamp_ns,
                [this](std::int64_t at_ns) { return track_.at(at_ns); })) {
    frame.points = std::move(points);
  }
  frame.point_times_ns.clear();
}

}  // namespace mosbench
