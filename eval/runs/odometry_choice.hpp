#pragma once

#include <filesystem>
#include <functional>
#include <mosbench/odometry.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// What the user asked of odometry, as typed.
struct OdometryOptions {
  std::optional<std::string> kind, preset;
  std::optional<std::filesystem::path> config_file;
  std::vector<std::string> assignments;
};

struct OdometryChoice {
  const OdometryKind* kind = nullptr;
  Settings settings;
};

/// Settings are defaults < preset < file < assignments. The preset's kind is taken when none is
/// named. Throws UsageError.
OdometryChoice choose_odometry(const OdometryOptions& options);

/// Which odometry with which settings, for the statement on how a sequence was read.
ReadingStatement statement_of(const OdometryChoice& choice);

/// Wraps every sequence of a data set that was opened without poses into a PosedSequence.
void expect_poses(Dataset& dataset, const OdometryChoice& choice);

/// Finds the poses of a sequence from its scans, telling `advance` of each. The same for any number
/// of threads. Throws DataError.
std::vector<ScanPose> estimate_poses(const Sequence& sequence, const OdometryChoice& choice,
                                     unsigned threads, const std::function<void()>& advance);

std::vector<Pose> poses_of(const std::vector<ScanPose>& scans);
std::size_t doubtful_count(const std::vector<ScanPose>& scans);
/// "poses by SiMpLE", and how many of them are doubtful with the first.
std::string odometry_remark(const Sequence& sequence, const OdometryChoice& choice,
                            const std::vector<ScanPose>& scans);

}  // namespace mosbench
