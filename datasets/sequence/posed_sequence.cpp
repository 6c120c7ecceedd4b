#include "datasets/sequence/posed_sequence.hpp"

#include <stdexcept>
#include <utility>

namespace mosbench {

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
  mutable_recording().remarks.push_back(std::move(remark));
}

void PosedSequence::read(std::size_t scan_index, Frame& frame) const {
  SequenceAround::read(scan_index, frame);
  frame.map_from_sensor = map_from_sensor(scan_index);
  deskewer_.apply(scan_index, frame);
}

}  // namespace mosbench
