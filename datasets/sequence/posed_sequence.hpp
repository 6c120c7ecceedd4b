#pragma once

#include <memory>
#include <string>
#include <vector>

#include "datasets/sequence/scan_deskewer.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// A sequence opened with `Reading::poses of ByOdometry` whose poses are found later. Scans
/// whose points have times are undistorted by the poses.
class PosedSequence : public SequenceAround {
 public:
  /// `how` replaces what the inner sequence states about poses. Poses are the identity until
  /// `set_poses`. Scans are deskewed by `deskew`, which is stated where the user asked for it.
  PosedSequence(std::unique_ptr<Sequence> inner, PosesDone how, Deskew deskew = Deskew::kPoses,
                bool states_deskew = false);

  /// One pose per scan. `remark` is what a reader of results should know about them. To be called
  /// before scans are read from several threads.
  void set_poses(const std::vector<Pose>& map_from_sensor, std::string remark);

  /// The sequence as it is without poses.
  const Sequence& unposed() const { return inner(); }

  using SequenceAround::read;
  void read(std::size_t scan_index, Frame& frame) const override;

 private:
  Deskew deskew_;
  ScanDeskewer deskewer_;
};

}  // namespace mosbench
