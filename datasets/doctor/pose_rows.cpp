#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "datasets/doctor/pose_evidence.hpp"
#include "datasets/text/numbers.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

// --- Equal rows.

/// Overlap of scans further apart, as share of that of neighbours, below which a sensor moves.
constexpr double kStandsShare = 0.93;
constexpr std::size_t kFewestFrozen = 3;
/// With shorter usual steps nothing is concluded from a jump.
constexpr double kLeastStepM = 0.03;
/// Of motions, this share turns more than `kMoves` where rotations are missing.
constexpr double kTurningShare = 0.15;

/// Returns whether scans overlap less the further apart they are, and better when moved: the sensor
/// does not stand. Not better, only something in view moves.
bool overlap_falls(const PoseEvidence& evidence) {
  if (evidence.best_overlap <= evidence.overlap) return false;
  std::vector<double> near, far;
  for (const MeasuredMotion& pair : evidence.measured.pairs) {
    (pair.consecutive() ? near : far).push_back(pair.given_overlap);
  }
  return !far.empty() && median(far) < kStandsShare * median(near);
}

/// Returns by how much the scans move while the rows are equal, median; 0 when that was not
/// measured.
double motion_within(const PoseEvidence& evidence, const RowRange& rows) {
  std::vector<double> misfits;
  for (const MeasuredMotion& pair : evidence.measured.pairs) {
    const bool within = pair.pair.earlier >= rows.first && pair.pair.later <= rows.last;
    if (within && pair.consecutive()) misfits.push_back(pair.misfit(Pose::Identity()).both());
  }
  return median(std::move(misfits));
}

double step_m(const std::vector<Pose>& poses, std::size_t row) {
  return (poses[row].translation() - poses[row - 1].translation()).norm();
}

double usual_step_m(const std::vector<Pose>& poses) {
  std::vector<double> steps_m;
  for (std::size_t row = 1; row < poses.size(); ++row) {
    if (const double moved_m = step_m(poses, row); moved_m > 0.0) steps_m.push_back(moved_m);
  }
  return median(std::move(steps_m));
}

/// Returns the length of the step after equal rows, as share of the way that usual steps make over
/// so many rows; 0 where that says nothing.
double jump_share(const std::vector<Pose>& poses, const RowRange& rows) {
  const double usual_m = usual_step_m(poses);
  const bool inside = rows.first > 0 && rows.last + 1 < poses.size();
  if (!inside || rows.rows() < kFewestFrozen || usual_m < kLeastStepM) return 0.0;
  return step_m(poses, rows.last + 1) / (static_cast<double>(rows.rows()) * usual_m);
}

std::string named_rows(const PoseEvidence& evidence, const std::vector<RowRange>& runs) {
  std::vector<std::string> names;
  for (const RowRange& run : runs) {
    names.push_back(fmt::format("rows {} to {} ({} to {})", run.first + 1, run.last + 1,
                                evidence.stems[run.first], evidence.stems[run.last]));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string sentence_on_frozen(const PoseEvidence& evidence, const std::vector<RowRange>& moving,
                               const std::vector<RowRange>& jumping) {
  if (!moving.empty() && moving.front().rows() == evidence.given.size()) {
    return "all poses are equal, but the scans show that the sensor moves; expected one pose per "
           "scan";
  }
  std::vector<std::string> parts;
  if (!moving.empty()) {
    parts.push_back(named_rows(evidence, moving) +
                    " are equal, while the scans show that the sensor moves");
  }
  if (!jumping.empty()) {
    parts.push_back(named_rows(evidence, jumping) +
                    " are equal, and then they jump over what they left out");
  }
  return fmt::format("the poses are frozen: {}; expected one pose per scan",
                     fmt::join(parts, "; "));
}

/// Returns the rows of the only frozen run, if it is at the end; else 0.
std::size_t examine_equal_rows(const PoseEvidence& evidence, Facts& facts) {
  std::vector<RowRange> moving, jumping;
  std::size_t longest = 0, at_end = 0;
  double most_motion = 0.0, largest_jump = 0.0;
  for (const RowRange& run : equal_rows(evidence.given)) {
    const double motion = motion_within(evidence, run), jump = jump_share(evidence.given, run);
    most_motion = std::max(most_motion, motion);
    largest_jump = std::max(largest_jump, jump);
    const bool whole = run.rows() == evidence.given.size();
    const bool moves = motion >= kMoves || (motion > 0.0 && whole && overlap_falls(evidence));
    if (!moves && jump < kJumpShare) continue;
    (moves ? moving : jumping).push_back(run);
    const bool only = moving.size() + jumping.size() == 1;
    at_end = only && run.last + 1 == evidence.given.size() ? run.rows() : 0;
    longest = std::max(longest, run.rows());
  }
  facts["moves_in_equal_rows"] = most_motion;
  facts["jump_share"] = largest_jump;
  facts["frozen_rows"] = longest;
  facts["frozen"] = sentence_on_frozen(evidence, moving, jumping);
  return at_end;
}

/// Measures how far motions turn that equal rotations do not, at the share of the motions that has
/// to turn.
void examine_rotations(const PoseEvidence& evidence, Facts& facts) {
  const std::vector<Pose>& poses = evidence.given;
  const bool all_turned_alike = std::ranges::all_of(poses, [&](const Pose& pose) {
    return pose.linear().isApprox(poses.front().linear(), 1e-9);
  });
  const std::vector<RowRange> equal = equal_rows(poses);
  if (!all_turned_alike || (!equal.empty() && equal.front().rows() == poses.size())) return;
  std::vector<double> turned;
  for (const MeasuredMotion& pair : evidence.measured.pairs) {
    turned.push_back(pair.misfit(evidence.given_motion(pair)).rotation);
  }
  facts["missing_turn"] =
      turned.empty() ? 0.0 : quantile(std::move(turned), 1.0 - kTurningShare, QuantileRule::kUpper);
}

/// Returns whether no pose moves in height by a micrometre, though others do by metres and the
/// poses roll or pitch, unlike those of a robot that knows a plane only. Straight roads have no y,
/// so that other axes say nothing.
bool lacks_height(const std::vector<Pose>& poses) {
  constexpr double kNowhereM = 1e-6, kSomewhereM = 1.0, kUpright = 1e-6;
  Eigen::Vector3d low = poses.front().translation(), high = low;
  double least_upright = 1.0, most_upright = -1.0;
  for (const Pose& pose : poses) {
    low = low.cwiseMin(pose.translation());
    high = high.cwiseMax(pose.translation());
    least_upright = std::min(least_upright, pose.linear()(2, 2));
    most_upright = std::max(most_upright, pose.linear()(2, 2));
  }
  const Eigen::Vector3d span_m = high - low;
  return span_m.maxCoeff() >= kSomewhereM && most_upright - least_upright >= kUpright &&
         span_m.z() < kNowhereM;
}

// --- Lost scans.

constexpr int kMostRowsLost = 4;
/// A shift over fewer scans at an end says nothing.
constexpr std::size_t kFewestScans = 6;
/// Lost scans explain the motions when they leave at most this share of the deviation.
constexpr double kLeftShare = 0.8;

/// Returns the split of the rows that gains most: those before a scan or from it on are shifted,
/// and poses are right on the other side.
std::pair<PoseConvention, double> best_split(const PoseEvidence& evidence) {
  const std::vector<MeasuredMotion>& pairs = evidence.measured.pairs;
  PoseConvention split{"", "", evidence.given};
  double best_gain = 0.0;
  for (int rows = -kMostRowsLost; rows <= kMostRowsLost; ++rows) {
    const PoseConvention other = shifted(evidence.given, rows);
    std::vector<double> gains;
    for (const MeasuredMotion& pair : pairs) {
      const auto claimed = other.motion(pair.pair);
      gains.push_back(claimed ? evidence.unlikeliness(pair, evidence.given_motion(pair)) -
                                    evidence.unlikeliness(pair, *claimed)
                              : 0.0);
    }
    for (const MeasuredMotion& step : pairs) {
      const std::size_t scan = step.pair.later;
      if (!step.consecutive() || scan < kFewestScans ||
          scan + kFewestScans > evidence.given.size()) {
        continue;
      }
      double before = 0.0, after = 0.0;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (pairs[i].pair.later < scan) before += gains[i];
        if (pairs[i].pair.earlier >= scan) after += gains[i];
      }
      if (std::max(before, after) <= best_gain) continue;
      best_gain = std::max(before, after);
      split.first = scan;
      split.rows_before = before > after ? rows : 0;
      split.rows_later = before > after ? 0 : rows;
    }
  }
  return {split, best_gain};
}

/// Looks for a scan from which on rows are shifted otherwise than before, which explains the
/// measured motions better than any one convention.
void examine_lost_scan(const PoseEvidence& evidence, std::size_t frozen_at_end, Facts& facts) {
  const auto best = best_convention(evidence.scores);
  const auto [split, gain] = best_split(evidence);
  if (gain < (best ? evidence.scores[*best].gain : 0.0) + kLeastGain) return;
  // Most motions fit, and far better than as given: poses of another way fit nowhere, though some
  // rows fit less badly.
  const ConventionScore score = score_of(evidence, split);
  if (score.median_misfit >= kFitting || score.unsound >= kLeftShare * score.given_unsound) return;
  const bool later = split.rows_later > split.rows_before;
  const auto rows = static_cast<std::size_t>(std::abs(split.rows_later - split.rows_before));
  facts["lost_rows"] = rows;
  facts["lost_rows_repeated"] = std::size_t{frozen_at_end == rows + 1};
  facts["lost"] = fmt::format(
      "from about scan {} on the poses are {} {} than before: expected one pose per scan ({} "
      "there?)",
      evidence.stems[split.first], counted(rows, "row"), later ? "later" : "earlier",
      later ? "was a scan lost" : "was a pose lost");
}

// --- Jumps.

/// Returns whether all motions across the step are off, and those beside it are not.
bool is_single(const PoseEvidence& evidence, const MeasuredMotion& step) {
  std::size_t across = 0;
  for (const MeasuredMotion& other : evidence.measured.pairs) {
    if (&other == &step) continue;
    const auto& [earlier, later] = other.pair;
    const bool near = earlier + 4 > step.pair.earlier && later < step.pair.later + 4;
    const bool is_off = evidence.off(other) > kFitting;
    if (near && other.consecutive() && is_off) return false;
    if (earlier >= step.pair.later || later < step.pair.later) continue;
    ++across;
    if (!is_off) return false;
  }
  return across > 0;
}

double length_m(const Pose& motion) { return difference_m(motion, Pose::Identity()); }

std::string sentence_on_jump(const PoseEvidence& evidence, const MeasuredMotion& jump) {
  constexpr double kTwice = 1.6;
  const double usual_m =
      evidence.median_over([](const auto& pair) { return length_m(pair.motion); }, true);
  const double moved_m = length_m(jump.motion);
  return fmt::format(
      "between scans {} and {} the poses move by {:.2f} m, the scans by {:.2f} m ({}); expected "
      "the same",
      evidence.stems[jump.pair.earlier], evidence.stems[jump.pair.later],
      length_m(evidence.given_motion(jump)), moved_m,
      moved_m > kTwice * usual_m
          ? "the scans make a longer step there than around it: was a scan lost?"
          : "the poses jump there, the scans do not");
}

void examine_jumps(const PoseEvidence& evidence, Facts& facts) {
  std::vector<std::string> sentences;
  double largest = 0.0;
  for (const MeasuredMotion& step : evidence.measured.pairs) {
    // Nothing speaks against poses under which the scans overlap best.
    const bool better = step.overlap > step.given_overlap;
    if (!better || !step.consecutive() || !is_single(evidence, step)) continue;
    const double off = evidence.off(step);
    largest = std::max(largest, off);
    if (off > kOutlier) sentences.push_back(sentence_on_jump(evidence, step));
  }
  facts["single_jump"] = largest;
  facts["jumps"] = sentences.size();
  facts["jump_steps"] = fmt::format("{}", fmt::join(sentences, "\n"));
}

// --- Scatter.

using Positions = std::vector<Eigen::Vector3d>;

Positions differences(const Positions& positions_m) {
  Positions between_m;
  for (std::size_t k = 1; k < positions_m.size(); ++k) {
    between_m.emplace_back(positions_m[k] - positions_m[k - 1]);
  }
  return between_m;
}

double median_length(const Positions& vectors) {
  std::vector<double> lengths;
  for (const Eigen::Vector3d& vector : vectors) lengths.push_back(vector.norm());
  return median(std::move(lengths));
}

}  // namespace

std::vector<RowRange> equal_rows(const std::vector<Pose>& poses) {
  std::vector<RowRange> runs;
  for (std::size_t row = 1; row < poses.size(); ++row) {
    if (poses[row].matrix() != poses[row - 1].matrix()) continue;
    if (runs.empty() || runs.back().last != row - 1) runs.push_back({row - 1, row});
    runs.back().last = row;
  }
  return runs;
}

std::vector<std::size_t> odd_steps(const std::vector<Pose>& poses, std::size_t most,
                                   double least_m) {
  constexpr std::size_t kAround = 4;
  std::vector<double> steps_m;
  for (std::size_t row = 1; row < poses.size(); ++row) {
    steps_m.push_back(difference_m(poses[row - 1], poses[row]));
  }
  std::vector<std::pair<double, std::size_t>> odd;
  for (std::size_t i = 0; i < steps_m.size(); ++i) {
    const std::size_t from = i < kAround ? 0 : i - kAround;
    const std::size_t to = std::min(i + kAround + 1, steps_m.size());
    const double usual_m = median({steps_m.begin() + static_cast<std::ptrdiff_t>(from),
                                   steps_m.begin() + static_cast<std::ptrdiff_t>(to)});
    odd.emplace_back(std::abs(steps_m[i] - usual_m), i + 1);
  }
  std::ranges::sort(odd, std::ranges::greater());
  odd.resize(std::min(odd.size(), most));
  std::vector<std::size_t> rows;
  for (const auto& [odd_m, row] : odd) {
    if (odd_m > least_m) rows.push_back(row);
  }
  return rows;
}

PoseScatter scatter_of(const std::vector<Pose>& poses, double step_s) {
  constexpr std::size_t kFewestScattered = 20;  // medians of fewer differences say little
  Positions positions_m;
  for (const Pose& pose : poses) positions_m.emplace_back(pose.translation());
  const Positions second_m = differences(differences(positions_m));
  if (second_m.size() < kFewestScattered) return {};
  // Second differences of noise have 6 times its variance, and the median length of three normal
  // numbers is 1.538 of their deviation.
  constexpr double kLengthOfNoise = 1.538 * 2.449;
  const double rough_m = median_length(second_m);
  if (!(rough_m > 0.0)) return {};
  return {rough_m / kLengthOfNoise, median_length(differences(second_m)) / rough_m,
          rough_m / (step_s * step_s)};
}

void examine_rows(const PoseEvidence& evidence, double step_s, Facts& facts) {
  const std::size_t frozen_at_end = examine_equal_rows(evidence, facts);
  examine_rotations(evidence, facts);
  examine_lost_scan(evidence, frozen_at_end, facts);
  examine_jumps(evidence, facts);
  facts["lacks_height"] = std::size_t{lacks_height(evidence.given)};
  const PoseScatter scatter = scatter_of(evidence.given, step_s);
  facts["scatter_m"] = scatter.noise_m;
  facts["whiteness"] = scatter.whiteness;
  facts["acceleration_m_s2"] = scatter.acceleration_m_s2;
}

}  // namespace mosbench
