#pragma once

#include <limits>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/job/odometry_choice.hpp"

namespace mosbench {

/// The choice with the default method as a filter, as it is set for the data set, if asked for.
OdometryChoice with_filter(OdometryChoice choice, DatasetKind kind);

/// Wraps every sequence of a data set that was opened without poses into a PosedSequence.
void expect_poses(Dataset& dataset, const OdometryChoice& choice);

/// Finds the poses of a sequence, or of its first scans, and tells how far it is. The same for any
/// number of threads. Throws DataError, and UsageError for a filter that labels scans later.
std::vector<ScanPose> estimate_poses(
    const Sequence& sequence, const OdometryChoice& choice, unsigned threads,
    std::size_t most_scans = std::numeric_limits<std::size_t>::max());

/// Finds the poses of a sequence that `expect_poses` wrapped, and tells how many are doubtful.
std::vector<ScanPose> find_poses(const Sequence& sequence, const OdometryChoice& choice,
                                 unsigned threads);

/// Gives a sequence that `expect_poses` wrapped the poses that were found.
void set_poses(Sequence& sequence, const OdometryChoice& choice,
               const std::vector<ScanPose>& scans);

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans);
std::size_t doubtful_count(const std::vector<ScanPose>& scans);

}  // namespace mosbench
