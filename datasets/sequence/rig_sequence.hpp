#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// One of several LiDARs that are mounted on one vehicle.
struct RigLidar {
  std::string name;
  std::unique_ptr<Sequence> sequence;  ///< without poses, but for the first LiDAR
  Pose first_from_this = Pose::Identity();
};

/// Several LiDARs as one. Scans, stamps and poses are those of the first one. To each of its scans
/// the scan of each other that is nearest in time, at most half a step away, is added behind it:
/// moved by its mount, with the origins of rays. Frames have the times of their points, by which a
/// ScanDeskewer moves them. Truth is where all scans of a frame have truth.
class RigSequence : public Sequence {
 public:
  /// `files` say how they are mounted. Throws DataError where scans have no stamps, or no scan of a
  /// LiDAR is near one of the first.
  explicit RigSequence(std::vector<RigLidar> lidars,
                       const std::vector<std::filesystem::path>& files = {});

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  /// For each scan of the first LiDAR that of another, where there is one.
  using Partners = std::vector<std::optional<std::size_t>>;

  double half_step_ms() const;
  Partners partners_of(const RigLidar& lidar) const;
  void take_in(const RigLidar& lidar, const Partners& partners);
  void state();

  std::vector<RigLidar> lidars_;
  std::vector<Partners> partners_;  ///< of the others
};

}  // namespace mosbench
