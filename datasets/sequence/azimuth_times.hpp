#pragma once

#include <cstdint>
#include <memory>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// When each point was measured after the stamp of its scan, by a sensor that turns clockwise once
/// in `turn_ns`, looks ahead (x) at the stamp, and behind at the beginning and end of the scan, as
/// that of KITTI does. In steps of a 10,000th of a turn; 0 for points that have no direction.
std::vector<std::int64_t> azimuth_times_ns(std::span<const Point> points, std::int64_t turn_ns);

/// A sequence whose points get the times of their azimuths. A turn takes as long as scans are
/// apart: the median of the stamps' intervals, or 0.1 s.
class AzimuthTimes : public SequenceAround {
 public:
  explicit AzimuthTimes(std::unique_ptr<Sequence> inner);

  using SequenceAround::read;
  void read(std::size_t scan_index, Frame& frame) const override;

 private:
  std::int64_t turn_ns_;
};

}  // namespace mosbench
