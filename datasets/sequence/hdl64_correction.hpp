#pragma once

#include <memory>
#include <mosbench/scan.hpp>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns the point raised by 0.205 degrees in the upright plane of its ray: KITTI's calibration
/// of its HDL-64E misses that angle (Deschaud, IMLS-SLAM, ICRA 2018; CT-ICP and KISS-ICP do the
/// same). A point on the z axis, a missing return among them, stays.
Point raised_by_hdl64_correction(const Point& point);

/// A sequence whose points are raised so.
class Hdl64Corrected : public SequenceAround {
 public:
  explicit Hdl64Corrected(std::unique_ptr<Sequence> inner);
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
};

}  // namespace mosbench
