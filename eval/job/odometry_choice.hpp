#pragma once

#include <filesystem>
#include <mosbench/method.hpp>
#include <mosbench/odometry.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/reading.hpp"
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
  bool drop_moving = false;        ///< what the job's method finds moving is to be the filter
};

/// Settings are defaults < preset < file < deskewing of `reading` < assignments. The preset's kind
/// is taken when none is named. Throws UsageError.
OdometryChoice choose_odometry(const OdometryOptions& options, const Reading& reading);

/// The choice when a kind is named; `options.poses` is then refused. Throws UsageError.
std::optional<OdometryChoice> named_odometry(const OdometryOptions& odometry,
                                             const Reading& reading);

/// The method with these settings, but without a delay.
MovingFilter moving_filter(const MethodKind& method, Settings settings);

/// Which odometry with which settings, for results.
OdometryDone odometry_done(const OdometryChoice& choice);
/// The same for the statement on how a sequence was read.
PosesDone statement_of(const OdometryChoice& choice);

}  // namespace mosbench
