#include "datasets/doctor/pose_diagnosis.hpp"

#include <algorithm>

#include "datasets/doctor/pose_findings.hpp"

namespace mosbench {
namespace {

/// Poses are faulty that are off so many times more than measured motions are off one another.
constexpr double kFarMore = 3.0;
/// Poses that no sensor has need to be off by no more than noise of 5 cm.
constexpr double kUnsoundScattering = 1.0;
/// Poses are faulty under which scans overlap by a smaller share of what they can: sound poses with
/// noise of 5 cm have 0.46 and more.
constexpr double kOverlapShare = 0.3;
/// No vehicle moves faster, metres per second: feet on a highway are 80 and more.
constexpr double kFastestMS = 70.0;
/// Of poses that scatter by a larger share of a step, the speed says nothing.
constexpr double kScatterOfStep = 0.2;
/// Time between scans where no stamps tell it.
constexpr double kUsualStepS = 0.1;

std::vector<PoseConvention> all_conventions(const std::vector<Pose>& given,
                                            const MeasuredMotions& measured,
                                            std::vector<PoseConvention> conventions) {
  std::ranges::move(shifted_rows(given), std::back_inserter(conventions));
  std::ranges::move(fitted_corrections(given, measured), std::back_inserter(conventions));
  return conventions;
}

void summarise(const PoseEvidence& evidence, PoseDiagnosis& result) {
  const auto given = [&](const MeasuredMotion& pair) { return evidence.given_motion(pair); };
  result.overlap = evidence.median_over([](const auto& pair) { return pair.given_overlap; });
  result.best_overlap = evidence.median_over([](const auto& pair) { return pair.overlap; });
  result.median_correction_m = evidence.median_over(
      [&](const auto& pair) { return difference_m(given(pair), pair.motion); });
  result.unsound = evidence.unsound([&](const auto& pair) { return std::optional(given(pair)); });
  result.fits = result.unsound < kUnsound;
  result.disagreement = evidence.disagreement;
}

/// Returns whether the poses are off by more than sound ones, and that is no fault of the
/// measurement: measured motions agree, or another convention is far better, or scans
/// hardly overlap under the poses, or no sensor moves as these do.
bool is_unsound(const PoseDiagnosis& result) {
  if (result.scatter.is_found() && result.unsound > kUnsoundScattering) return true;
  return result.unsound > kUnsound && (result.unsound > kFarMore * result.disagreement ||
                                       best_gain(result.scores) > kLeastGain ||
                                       result.overlap < kOverlapShare * result.best_overlap);
}

/// Returns the given motion per second, median; 0 without stamps.
double speed_m_s(const PoseEvidence& evidence, const ScanSteps& scans) {
  if (!scans.step_s) return 0.0;
  const double step_m = evidence.median_over(
      [&](const auto& pair) { return evidence.given_motion(pair).translation().norm(); }, true);
  return step_m / *scans.step_s;
}

bool is_too_fast(const PoseDiagnosis& result, double fast_m_s, double step_s) {
  return fast_m_s > kFastestMS && result.scatter.noise_m < kScatterOfStep * fast_m_s * step_s;
}

/// Returns what the first kind of fault that fits says, the most certain ones first.
std::vector<std::string> findings_of(const PoseEvidence& evidence, const PoseDiagnosis& result,
                                     double fast_m_s, double step_s) {
  if (const auto found = missing_rotation(evidence)) return {*found};
  const std::optional<FrozenRows> frozen = frozen_rows(evidence);
  // Shifts repeat fewer rows at an end.
  if (frozen && frozen->longest > kMostRowsShifted) return {frozen->finding};
  const std::optional<LostScan> lost = lost_scan(evidence, best_gain(result.scores));
  // Rows are repeated at the end to make up for lost ones.
  if (lost && frozen && frozen->at_end == lost->rows + 1) return {lost->finding};
  if (const auto found = better_convention(result.conventions, result.scores)) return {*found};
  if (frozen) return {frozen->finding};
  if (lost) return {lost->finding};
  if (const auto found = jumps(evidence); !found.empty()) return found;
  if (const auto found = deleted_axis(evidence)) return {*found};
  if (is_too_fast(result, fast_m_s, step_s)) return {too_fast(fast_m_s)};
  if (is_unsound(result)) return {unexplained(evidence, result.scatter)};
  return {};
}

std::map<std::string, double> measures_of(const PoseEvidence& evidence, const PoseDiagnosis& result,
                                          double fast_m_s) {
  std::map<std::string, double> measures = {
      {"unsound", result.unsound},
      {"disagreement", result.disagreement},
      {"overlap_share", result.best_overlap > 0.0 ? result.overlap / result.best_overlap : 1.0},
      {"speed_m_s", fast_m_s},
      {"scatter_m", result.scatter.noise_m},
      {"whiteness", result.scatter.whiteness},
      {"acceleration_m_s2", result.scatter.acceleration_m_s2}};
  measures.merge(row_measures(evidence));
  measures.merge(convention_measures(result.scores));
  measures.merge(jump_measures(evidence));
  return measures;
}

}  // namespace

PoseDiagnosis diagnose(const std::vector<Pose>& given, const MeasuredMotions& measured,
                       std::vector<PoseConvention> conventions, const ScanSteps& scans) {
  PoseDiagnosis result;
  result.scans_read = measured.scans_read;
  result.conventions = all_conventions(given, measured, std::move(conventions));
  PoseEvidence evidence{given, measured.pairs, scans.stems};
  evidence.noise = noise_of_poses(evidence, result.conventions);
  evidence.disagreement = evidence.unsound([&](const auto& pair) {
    return pair.consecutive() ? std::nullopt : std::optional(pair.chained);
  });
  summarise(evidence, result);
  for (const PoseConvention& convention : result.conventions) {
    result.scores.push_back(score_of(evidence, convention));
  }
  const double step_s = scans.step_s.value_or(kUsualStepS);
  result.scatter = scatter_of(given, step_s);
  const double fast_m_s = speed_m_s(evidence, scans);
  result.findings = findings_of(evidence, result, fast_m_s, step_s);
  if (result.findings.empty()) result.remarks = remarks_on_rows(evidence);
  const auto other = better_convention(result.conventions, result.scores);
  if (other && result.findings == std::vector{*other}) {
    result.flags = flags_for(result.conventions, result.scores);
  }
  result.measures = measures_of(evidence, result, fast_m_s);
  return result;
}

}  // namespace mosbench
