#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/engine/pose_finding.hpp"

namespace mosbench {

/// Where the poses of a data set are written to.
struct PoseFiles {
  std::filesystem::path out = {};  ///< a file, "-" is stdout; a folder for several sequences
  bool as_tum = false;             ///< else as KITTI's rows
  bool overwrite = false;          ///< else what holds something stays, and the call is refused
  unsigned threads = 1;
};

/// Finds and writes the poses of every sequence of a data set that was opened without poses, and
/// whose sequences `expect_poses` wrapped; writes those that it has without a choice. Of several,
/// those that an earlier call finished are kept. What is in the way is found before any work. The
/// sequences have these poses then. Throws UsageError and DataError.
std::vector<FoundPoses> write_poses(Dataset& dataset, const std::optional<OdometryChoice>& choice,
                                    const PoseFiles& files);

}  // namespace mosbench
