#pragma once

#include <map>
#include <memory>
#include <mosbench/odometry.hpp>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/kept_scans.hpp"
#include "eval/engine/pose_finding.hpp"

namespace mosbench {

/// What several runs over the same data read and compute alike: scans are read once, as many of
/// each sequence as fit in a quarter of the machine's memory and in 2 GiB, and poses are found
/// once.
class SharedReading {
 public:
  /// Makes a run's data set, which was opened as those of the other runs were, read by this.
  void share(Dataset& dataset);

  /// Returns the poses by odometry of the sequence at this position of the data set, the same for
  /// every run unless what a run's method finds moving is left out of them. As `find_poses`.
  std::vector<ScanPose> poses_of(std::size_t position, const Sequence& sequence,
                                 const OdometryChoice& choice, unsigned threads);

  /// Forgets what was read of a sequence.
  void forget(std::size_t position);

 private:
  std::map<std::size_t, std::shared_ptr<KeptScans>> scans_;  ///< by position
  std::map<std::size_t, std::vector<ScanPose>> poses_;
};

}  // namespace mosbench
