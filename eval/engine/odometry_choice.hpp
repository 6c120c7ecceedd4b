#pragma once

#include <filesystem>
#include <limits>
#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// What the user asked of odometry, as typed.
struct OdometryOptions {
  std::optional<std::string> kind, preset;
  std::optional<std::filesystem::path> config_file;
  std::vector<std::string> assignments;
  bool drop_moving = false;

  /// Whether anything was said without a kind.
  bool says_anything() const;
};

/// An online method whose moving points stay out of the map that scans are registered to.
struct MovingFilter {
  const MethodKind* method = nullptr;
  Settings settings;
};

struct OdometryChoice {
  const OdometryKind* kind = nullptr;
  Settings settings;
  std::optional<MovingFilter> filter = std::nullopt;
  Deskew deskew = Deskew::kPoses;  ///< of the scans once their poses are found
  bool says_deskew = false;        ///< whether the user did
};

/// Settings are defaults < preset < file < deskewing of `reading` < assignments. The preset's kind
/// is taken when none is named. Throws UsageError.
OdometryChoice choose_odometry(const OdometryOptions& options, const Reading& reading);

/// The choice when a kind is named; `options.poses` is then refused. Throws UsageError.
std::optional<OdometryChoice> named_odometry(const OdometryOptions& odometry,
                                             const Reading& reading);

/// The method with these settings, but without a delay.
MovingFilter moving_filter(const MethodKind& method, Settings settings);

/// The choice with the default method as a filter, as it is set for the data set, if asked for.
OdometryChoice with_filter(OdometryChoice choice, const OdometryOptions& options, DatasetKind kind);

/// Which odometry with which settings, for results.
OdometryDone odometry_done(const OdometryChoice& choice);
/// The same for the statement on how a sequence was read.
PosesDone statement_of(const OdometryChoice& choice);

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
