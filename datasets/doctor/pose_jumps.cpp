#include <fmt/format.h>

#include "datasets/doctor/pose_findings.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kMostJumps = 3;
/// More than that is no noise but other poses.
constexpr double kMostScatterM = 0.3;
/// A step that is off by more is an outlier.
constexpr double kOutlier = 12.0;

bool spans(const MeasuredMotion& pair, std::size_t row) {
  return pair.pair.earlier < row && pair.pair.later >= row;
}

/// Returns whether all motions across the step are off, and those beside it are not.
bool is_single(const PoseEvidence& evidence, const MeasuredMotion& step) {
  std::size_t across = 0;
  for (const MeasuredMotion& pair : evidence.pairs) {
    if (&pair == &step) continue;
    const bool near = pair.pair.earlier + 4 > step.pair.earlier &&
                      pair.pair.later < step.pair.later + 4 && pair.consecutive();
    if (near && evidence.off(pair) > kFitting) return false;
    if (!spans(pair, step.pair.later)) continue;
    ++across;
    if (evidence.off(pair) < kFitting) return false;
  }
  return across > 0;
}

std::string sentence_on_jump(const PoseEvidence& evidence, const MeasuredMotion& jump) {
  const double moved_m = difference_m(jump.motion, Pose::Identity());
  const double usual_m = evidence.median_over(
      [](const auto& pair) { return difference_m(pair.motion, Pose::Identity()); }, true);
  constexpr double kTwice = 1.6;
  const std::string what =
      moved_m > kTwice * usual_m
          ? "the scans make a longer step there than around it: was a scan lost?"
          : "the poses jump there, the scans do not";
  return fmt::format(
      "between scans {} and {} the poses move by {:.2f} m, the scans by {:.2f} m "
      "({}); expected the same",
      evidence.stems[jump.pair.earlier], evidence.stems[jump.pair.later],
      difference_m(evidence.given_motion(jump), Pose::Identity()), moved_m, what);
}

}  // namespace

std::vector<std::string> jumps(const PoseEvidence& evidence) {
  std::vector<std::string> sentences;
  for (const MeasuredMotion& step : evidence.pairs) {
    // Nothing speaks against poses under which the scans overlap best.
    const bool better = step.overlap > step.given_overlap;
    if (better && step.consecutive() && evidence.off(step) > kOutlier &&
        is_single(evidence, step)) {
      sentences.push_back(sentence_on_jump(evidence, step));
    }
  }
  if (sentences.size() > kMostJumps) return {};
  return sentences;
}

std::string too_fast(double speed_m_s) {
  return fmt::format(
      "the poses move at {:.0f} m/s (median); expected metres at the speed of a vehicle (are these "
      "feet or millimetres?)",
      speed_m_s);
}

std::map<std::string, double> jump_measures(const PoseEvidence& evidence) {
  double largest = 0.0;
  for (const MeasuredMotion& step : evidence.pairs) {
    const bool better = step.overlap > step.given_overlap;
    if (better && step.consecutive() && is_single(evidence, step)) {
      largest = std::max(largest, evidence.off(step));
    }
  }
  return {{"single_jump", largest}};
}

std::string unexplained(const PoseEvidence& evidence, const PoseScatter& scatter) {
  if (scatter.is_found() && scatter.noise_m < kMostScatterM) {
    return fmt::format(
        "the poses scatter by {:.2f} m from scan to scan around a smooth way; expected less than "
        "0.05 m",
        scatter.noise_m);
  }
  const std::string scattered =
      scatter.is_found()
          ? fmt::format(", and they scatter by {:.2f} m from scan to scan", scatter.noise_m)
          : "";
  return fmt::format(
      "the poses do not fit the scans in any convention: they are off the motion of the scans "
      "by {:.2f} m (median of {}), and scans overlap by {:.2f} instead of {:.2f}{}; expected the "
      "poses of this sequence",
      evidence.median_over(
          [&](const auto& pair) { return difference_m(evidence.given_motion(pair), pair.motion); }),
      evidence.pairs.size(),
      evidence.median_over([](const auto& pair) { return pair.given_overlap; }),
      evidence.median_over([](const auto& pair) { return pair.overlap; }), scattered);
}

}  // namespace mosbench
