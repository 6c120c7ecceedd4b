#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/formats/helipr_points.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// One LiDAR of a recording of HeLiPR as it is published: LiDAR/<sensor>/<stamp_ns>.bin with packed
/// points, poses in LiDAR_GT/<sensor>_gt.txt. It has no truth; HeLiMOS labels part of KAIST05.
class HeliprSequence : public Sequence {
 public:
  /// `folder` is LiDAR/<sensor>. Throws DataError.
  HeliprSequence(std::string name, const std::filesystem::path& folder, const Reading& asked);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  void list_scans(const std::filesystem::path& folder);
  void take_ground_truth(const std::filesystem::path& file, double max_gap_s);
  void take_poses(const std::filesystem::path& folder, const Reading& asked);

  HeliprSensor sensor_;
  bool gives_times_;
};

}  // namespace mosbench
