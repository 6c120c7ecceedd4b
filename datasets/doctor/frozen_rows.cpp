#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/doctor/pose_findings.hpp"
#include "datasets/doctor/row_patterns.hpp"
#include "datasets/text/quantile.hpp"

namespace mosbench {
namespace {

/// Equal rows while scans move, in units of the registration's own errors.
constexpr double kMoves = 9.0;
/// Overlap of scans further apart, as share of that of neighbours, below which a sensor moves.
constexpr double kStandsShare = 0.93;
/// So many equal rows that end in a jump over at least this share of the way that usual steps make
/// were frozen; a vehicle that stood starts slowly.
constexpr std::size_t kFewestFrozen = 3;
constexpr double kJumpShare = 0.6;
/// With shorter usual steps nothing is concluded from a jump.
constexpr double kLeastStepM = 0.03;
/// Of motions, this share turns more than `kMoves` where rotations are missing.
constexpr double kTurningShare = 0.15;

bool all_equal(const std::vector<Pose>& poses) {
  const std::vector<RowRange> runs = equal_rows(poses);
  return !runs.empty() && runs.front().rows() == poses.size();
}

/// Returns whether scans overlap less the further apart they are, and better when moved: the sensor
/// does not stand. Not better, only something in view moves.
bool overlap_falls(const PoseEvidence& evidence) {
  const double given = evidence.median_over([](const auto& pair) { return pair.given_overlap; });
  const double best = evidence.median_over([](const auto& pair) { return pair.overlap; });
  if (best <= given) return false;
  std::vector<double> near, far;
  for (const MeasuredMotion& pair : evidence.pairs) {
    (pair.consecutive() ? near : far).push_back(pair.given_overlap);
  }
  return !far.empty() && median(far) < kStandsShare * median(near);
}

/// Returns by how much the scans move while the rows are equal, median; 0 when that was not
/// measured.
double motion_within(const PoseEvidence& evidence, const RowRange& rows) {
  std::vector<double> misfits;
  for (const MeasuredMotion& pair : evidence.pairs) {
    const bool within = pair.pair.earlier >= rows.first && pair.pair.later <= rows.last;
    if (within && pair.consecutive()) misfits.push_back(pair.misfit(Pose::Identity()).both());
  }
  return misfits.empty() ? 0.0 : median(std::move(misfits));
}

bool scans_move(const PoseEvidence& evidence, const RowRange& rows) {
  const double motion = motion_within(evidence, rows);
  const bool whole = rows.rows() == evidence.given.size();
  return motion >= kMoves || (motion > 0.0 && whole && overlap_falls(evidence));
}

double step_m(const std::vector<Pose>& poses, std::size_t row) {
  return (poses[row].translation() - poses[row - 1].translation()).norm();
}

double usual_step_m(const std::vector<Pose>& poses) {
  std::vector<double> steps_m;
  for (std::size_t row = 1; row < poses.size(); ++row) {
    if (const double moved_m = step_m(poses, row); moved_m > 0.0) steps_m.push_back(moved_m);
  }
  return steps_m.empty() ? 0.0 : median(std::move(steps_m));
}

/// Returns the length of the step after equal rows, as share of the way that usual steps make over
/// so many rows; 0 where that says nothing.
double jump_share(const std::vector<Pose>& poses, const RowRange& rows) {
  const double usual_m = usual_step_m(poses);
  const bool inside = rows.first > 0 && rows.last + 1 < poses.size();
  if (!inside || rows.rows() < kFewestFrozen || usual_m < kLeastStepM) return 0.0;
  return step_m(poses, rows.last + 1) / (static_cast<double>(rows.rows()) * usual_m);
}

std::string named_rows(const PoseEvidence& evidence, const RowRange& run) {
  return fmt::format("rows {} to {} ({} to {})", run.first + 1, run.last + 1,
                     evidence.stems[run.first], evidence.stems[run.last]);
}

/// Returns how far motions turn that the poses do not, at the share of the motions that has to.
double missing_turn(const PoseEvidence& evidence) {
  std::vector<double> turned;
  for (const MeasuredMotion& pair : evidence.pairs) {
    turned.push_back(pair.misfit(evidence.given_motion(pair)).rotation);
  }
  return turned.empty() ? 0.0
                        : quantile(std::move(turned), 1.0 - kTurningShare, QuantileRule::kUpper);
}

bool lacks_rotation(const PoseEvidence& evidence) {
  return !all_equal(evidence.given) && all_rotations_equal(evidence.given);
}

}  // namespace

std::optional<FrozenRows> frozen_rows(const PoseEvidence& evidence) {
  std::vector<std::string> moving, jumping;
  FrozenRows frozen;
  for (const RowRange& run : equal_rows(evidence.given)) {
    if (scans_move(evidence, run)) {
      moving.push_back(named_rows(evidence, run));
    } else if (jump_share(evidence.given, run) >= kJumpShare) {
      jumping.push_back(named_rows(evidence, run));
    } else {
      continue;
    }
    const bool only = moving.size() + jumping.size() == 1;
    frozen.at_end = only && run.last + 1 == evidence.given.size() ? run.rows() : 0;
    frozen.longest = std::max(frozen.longest, run.rows());
  }
  if (!moving.empty() && all_equal(evidence.given)) {
    frozen.finding =
        "all poses are equal, but the scans show that the sensor moves; expected one pose per scan";
    return frozen;
  }
  std::vector<std::string> parts;
  if (!moving.empty()) {
    parts.push_back(fmt::format("{} are equal, while the scans show that the sensor moves",
                                fmt::join(moving, ", ")));
  }
  if (!jumping.empty()) {
    parts.push_back(fmt::format("{} are equal, and then they jump over what they left out",
                                fmt::join(jumping, ", ")));
  }
  if (parts.empty()) return std::nullopt;
  frozen.finding =
      fmt::format("the poses are frozen: {}; expected one pose per scan", fmt::join(parts, "; "));
  return frozen;
}

std::optional<std::string> missing_rotation(const PoseEvidence& evidence) {
  if (!lacks_rotation(evidence) || missing_turn(evidence) < kMoves) return std::nullopt;
  return "all poses have the same rotation, but the scans show that the sensor turns; expected "
         "rotations";
}

std::vector<std::string> remarks_on_rows(const PoseEvidence& evidence) {
  if (!lacks_rotation(evidence)) return {};
  return {"all poses have the same rotation; the scans do not show whether the sensor turns"};
}

std::map<std::string, double> row_measures(const PoseEvidence& evidence) {
  double motion = 0.0, jump = 0.0;
  for (const RowRange& run : equal_rows(evidence.given)) {
    motion = std::max(motion, motion_within(evidence, run));
    jump = std::max(jump, jump_share(evidence.given, run));
  }
  std::map<std::string, double> measures = {{"moves_in_equal_rows", motion}, {"jump_share", jump}};
  if (lacks_rotation(evidence)) measures["missing_turn"] = missing_turn(evidence);
  return measures;
}

std::optional<std::string> deleted_axis(const PoseEvidence& evidence) {
  constexpr int kUp = 2;
  if (constant_axis(evidence.given) != kUp) return std::nullopt;
  return "all poses have the same z while they roll and pitch; expected positions in all three "
         "dimensions";
}

}  // namespace mosbench
