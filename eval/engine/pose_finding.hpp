#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mosbench/odometry.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/kept_scans.hpp"
#include "datasets/sequence/sequence.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/result/result.hpp"

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

/// Returns those that odometry does not trust.
std::vector<DoubtfulPose> doubtful_poses(const Sequence& sequence,
                                         const std::vector<ScanPose>& scans);

/// Returns what is to be known of the poses of a sequence once they are a file.
PoseMark mark_of_poses(const Sequence& sequence);

/// Gives a sequence that `expect_poses` wrapped the poses that were found, and a doubt where some
/// are doubtful.
void set_poses(Sequence& sequence, const OdometryChoice& choice,
               const std::vector<ScanPose>& scans);

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans);

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

/// The poses of one sequence, with all that is known of them as --json prints it.
struct FoundPoses {
  const Sequence& sequence;
  std::filesystem::path file;
  nlohmann::ordered_json scans;
};

/// What is known of every scan's pose, as `FoundPoses::scans`.
nlohmann::ordered_json scans_json(const Sequence& sequence, const std::vector<ScanPose>& poses);
/// The same of poses that the sequence has, of which no more is known.
nlohmann::ordered_json scans_json(const Sequence& sequence);

/// Throws UsageError unless every scan has a stamp, and a later one than the scan before: rows of
/// TUM are found by their stamps.
void check_stamps_of_tum(const Sequence& sequence);

/// The rows of a TUM file of poses with these stamps, one for each.
std::string tum_rows(const std::vector<std::int64_t>& stamps_ns, const std::vector<Pose>& poses);

/// Throw a JSON exception for scans that `scans_json` did not write.
std::vector<Pose> poses_of(const FoundPoses& found);
std::vector<DoubtfulPose> doubtful_poses(const FoundPoses& found);
/// The rows of a file of poses, of KITTI or, for scans with stamps, of TUM.
std::string pose_rows(const FoundPoses& found, bool as_tum);

/// How many poses there are and why the first of the doubtful ones are doubtful.
std::string found_text(const FoundPoses& found, std::string_view odometry);
nlohmann::ordered_json found_json(const FoundPoses& found);

}  // namespace mosbench
