#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/layouts/kitti_drive.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// A drive of KITTI's raw data or of its tracking benchmark. Truth, where there is any: 251 in
/// boxes that move, 9 elsewhere in the view of camera 2, 0 beyond it, in regions that nobody
/// labelled, and in boxes that are seen once; in the upper 16 bits the object of a box. Frames
/// that are within such a box as a whole have none.
class KittiDriveSequence : public Sequence {
 public:
  /// Throws DataError; MissingPoses for a drive without oxts or calibration.
  KittiDriveSequence(KittiDrive drive, const Reading& asked);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  void list_scans(const KittiDrive& drive);
  void take_oxts(const KittiDrive& drive);
  void take_poses(const KittiDrive& drive, const Reading& asked);
  std::vector<std::uint32_t> truth_of(std::size_t frame, std::span<const Point> points) const;

  std::size_t bin_columns_;
  CameraView view_;
  std::vector<std::vector<LabelledBox>> boxes_;  ///< by frame
  std::map<std::size_t, std::vector<ImageRegion>> unlabelled_;
};

}  // namespace mosbench
