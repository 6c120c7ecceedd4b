#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kFewestTellingPairs = 3, kFewestShiftPairs = 6;
/// Differences of log likelihood below show nothing.
constexpr double kTelling = 0.2;
/// Conventions within this share of the best gain are as good.
constexpr double kSameShare = 0.9;
constexpr std::size_t kMostTries = 4;
/// It has to gain more then: shifts over a straight road at one speed all fit most motions.
constexpr double kClearGain = 2.0 * kLeastGain;
/// The same as kExplainedShare of shifted rows. Right ones left 0.71 (highway) and less where the
/// measured motions agree, one beside a reversed block of rows 0.99.
constexpr double kExplainedShareOfRows = 0.85;
/// Time between scans where no stamps tell it.
constexpr double kUsualStepS = 0.1;

/// Returns the conventions that are better, best first.
std::vector<std::size_t> better_ones(const std::vector<ConventionScore>& scores) {
  std::vector<std::size_t> better;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i].is_better) better.push_back(i);
  }
  std::ranges::sort(better, std::ranges::greater(), [&](std::size_t i) { return scores[i].gain; });
  return better;
}

/// Returns the conventions that explain the measured motions about as well as the best one, best
/// first; none where that one does not.
std::vector<std::size_t> as_good_as_the_best(const std::vector<ConventionScore>& scores) {
  std::vector<std::size_t> better = better_ones(scores);
  if (better.empty() || !scores[better.front()].explains) return {};
  const double enough = kSameShare * scores[better.front()].gain;
  std::erase_if(better,
                [&](std::size_t i) { return !scores[i].explains || scores[i].gain < enough; });
  return better;
}

/// Returns PoseEvidence::noise.
double noise_of_poses(const PoseEvidence& evidence) {
  double noise = evidence.median_over(
      [&](const auto& pair) { return pair.misfit(evidence.given_motion(pair)).both(); });
  for (const PoseConvention& convention : evidence.conventions) {
    std::vector<double> misfits;
    for (const MeasuredMotion& pair : evidence.measured.pairs) {
      const auto claimed = convention.motion(pair.pair);
      if (claimed) misfits.push_back(pair.misfit(*claimed).both());
    }
    if (2 * misfits.size() > evidence.measured.pairs.size())
      noise = std::min(noise, median(misfits));
  }
  return std::max(noise, 1.0);
}

/// Says whether the convention is better than the given poses, and whether it explains the motions.
void judge(const PoseEvidence& evidence, const PoseConvention& convention, ConventionScore& score) {
  const std::size_t fewest = convention.rows_later != 0 ? kFewestShiftPairs : kFewestTellingPairs;
  score.is_better = score.pairs >= fewest && score.gain > kLeastGain &&
                    score.gain > (convention.stands ? kLeastMeanGainOfRest : kLeastMeanGain) *
                                     static_cast<double>(score.pairs);
  // Where many motions are measured wrongly, a cause is one under which most fit and few do not.
  // Shifts are not asked to where measured motions contradict one another: those leave much anyway.
  const double left_share = convention.rows_later == 0    ? kExplainedShare
                            : evidence.disagreement < 1.0 ? kExplainedShareOfRows
                                                          : std::numeric_limits<double>::infinity();
  const bool most_fit = !convention.stands && score.median_misfit < kFitting &&
                        score.gain > kClearGain && score.unsound < left_share * score.given_unsound;
  score.explains = score.is_better && (score.unsound < kUnsound || most_fit);
}

/// Compares the poses with the motions that scans show.
void compare(PoseEvidence& evidence, const std::vector<PoseConvention>& conventions) {
  const auto given = [&](const auto& pair) { return evidence.given_motion(pair); };
  evidence.conventions = conventions;
  std::ranges::move(fitted_corrections(evidence.given, evidence.measured),
                    std::back_inserter(evidence.conventions));
  evidence.noise = noise_of_poses(evidence);
  evidence.deviation = evidence.unsound(given);
  evidence.disagreement = evidence.unsound([&](const auto& pair) {
    return pair.consecutive() ? std::nullopt : std::optional(pair.chained);
  });
  evidence.overlap = evidence.median_over([](const auto& pair) { return pair.given_overlap; });
  evidence.best_overlap = evidence.median_over([](const auto& pair) { return pair.overlap; });
  evidence.median_correction_m = evidence.median_over(
      [&](const auto& pair) { return difference_m(given(pair), pair.motion); });
  evidence.scores.clear();
  for (const PoseConvention& convention : evidence.conventions) {
    evidence.scores.push_back(score_of(evidence, convention));
  }
}

/// Returns the best conventions, from which to register scans again, when the best one does not
/// explain the measured motions: registration that starts from wrong poses may have missed them.
std::vector<MotionGuess> worth_another_try(const PoseEvidence& evidence) {
  std::vector<std::size_t> better = better_ones(evidence.scores);
  if (better.empty() || evidence.scores[better.front()].explains) return {};
  better.resize(std::min(better.size(), kMostTries));
  std::vector<MotionGuess> guesses;
  for (const std::size_t i : better) {
    guesses.push_back([convention = evidence.conventions[i]](const ScanPair& pair) {
      return convention.motion(pair);
    });
  }
  return guesses;
}

/// Returns "as one row later" or "with the points mirrored".
std::string reading_of(const PoseConvention& convention) {
  const std::string& name = convention.name;
  if (name.starts_with("with ") || name.starts_with("in ")) return name;
  return (name.starts_with("of ") ? "as poses " : "as ") + name;
}

std::string sentence_on(const PoseEvidence& poses, const std::vector<std::size_t>& better) {
  const ConventionScore& score = poses.scores[better.front()];
  const std::string off = fmt::format(
      "they are off the motion of the scans by {:.2f} m instead of {:.2f} m (median of {})",
      score.off_m, score.given_off_m, score.pairs);
  std::vector<std::string> names;
  for (const std::size_t i : better) names.push_back(reading_of(poses.conventions[i]));
  if (better.size() == 1) {
    return fmt::format("the poses fit better {}: {}; {}", names.front(), off,
                       poses.conventions[better.front()].advice);
  }
  return fmt::format(
      "the poses fit better {} (which of these cannot be told from these scans): {}; expected "
      "poses that fit as given",
      fmt::join(names, " or "), off);
}

/// Tells which conventions fit better, and what the one that gains most reaches.
void tell_conventions(const PoseEvidence& poses, Facts& facts) {
  const std::vector<std::size_t> better = as_good_as_the_best(poses.scores);
  facts["better_conventions"] = better.size();
  if (!better.empty()) facts["conventions"] = sentence_on(poses, better);
  const auto best = std::ranges::max_element(poses.scores, {}, &ConventionScore::gain);
  facts["gain"] = best->gain;
  facts["mean_gain"] = best->gain / static_cast<double>(std::max<std::size_t>(best->pairs, 1));
  facts["explained_misfit"] = best->median_misfit;
  if (best->given_unsound > 0.0) {
    facts["explained_share"] = best->unsound / best->given_unsound;
  }
  if (const auto i = best_convention(poses.scores)) facts["better_gain"] = poses.scores[*i].gain;
}

void tell(const PoseEvidence& poses, std::optional<double> stamped_step_s, Facts& facts) {
  const double step_m = poses.median_over(
      [&](const auto& pair) { return poses.given_motion(pair).translation().norm(); }, true);
  const double step_s = stamped_step_s.value_or(kUsualStepS);
  facts["unsound"] = poses.deviation;
  facts["far_more"] = poses.deviation / std::max(poses.disagreement, 1e-12);
  facts["overlap"] = poses.overlap;
  facts["best_overlap"] = poses.best_overlap;
  facts["overlap_share"] = poses.best_overlap > 0.0 ? poses.overlap / poses.best_overlap : 1.0;
  facts["off_m"] = poses.median_correction_m;
  facts["motions"] = poses.measured.pairs.size();
  facts["poses_fit"] = std::size_t{poses.fits()};
  tell_conventions(poses, facts);
  examine_rows(poses, step_s, facts);
  if (!stamped_step_s || step_m == 0.0) return;
  facts["speed_m_s"] = step_m / *stamped_step_s;
  facts["scatter_of_step"] = *facts.number("scatter_m") / step_m;
}

}  // namespace

double PoseEvidence::unlikeliness(const MeasuredMotion& pair, const Pose& claimed) const {
  return std::log1p(pair.misfit(claimed).both() / noise);
}

double PoseEvidence::off(const MeasuredMotion& pair) const {
  const Misfit misfit = pair.unsound(given_motion(pair));
  return std::max(misfit.translation, misfit.rotation);
}

double PoseEvidence::median_over(const std::function<double(const MeasuredMotion&)>& value,
                                 bool only_steps) const {
  std::vector<double> values;
  for (const MeasuredMotion& pair : measured.pairs) {
    if (!only_steps || pair.consecutive()) values.push_back(value(pair));
  }
  return median(std::move(values));
}

double PoseEvidence::unsound(
    const std::function<std::optional<Pose>(const MeasuredMotion&)>& motion_of) const {
  // A motion counts at most so much, so that few do not decide.
  constexpr double kMostUnsound = 25.0;
  double translation = 0.0, rotation = 0.0, count = 0.0;
  for (const MeasuredMotion& pair : measured.pairs) {
    const std::optional<Pose> claimed = motion_of(pair);
    if (!claimed) continue;
    const Misfit misfit = pair.unsound(*claimed);
    translation += std::min(misfit.translation, kMostUnsound);
    rotation += std::min(misfit.rotation, kMostUnsound);
    count += 1.0;
  }
  return std::max(translation, rotation) / std::max(count, 1.0);
}

ConventionScore score_of(const PoseEvidence& evidence, const PoseConvention& convention) {
  ConventionScore score;
  std::vector<double> off_m, given_off_m, misfits;
  for (const MeasuredMotion& pair : evidence.measured.pairs) {
    const auto claimed = convention.motion(pair.pair);
    if (!claimed) continue;
    const Pose given = evidence.given_motion(pair);
    const double gain = evidence.unlikeliness(pair, given) - evidence.unlikeliness(pair, *claimed);
    score.gain += gain;
    misfits.push_back(pair.unsound(*claimed).both());
    if (std::abs(gain) < kTelling) continue;
    ++score.pairs;
    off_m.push_back(difference_m(*claimed, pair.motion));
    given_off_m.push_back(difference_m(given, pair.motion));
  }
  if (score.pairs == 0) return score;
  score.off_m = median(off_m);
  score.given_off_m = median(given_off_m);
  score.unsound = evidence.unsound([&](const auto& pair) { return convention.motion(pair.pair); });
  score.given_unsound = evidence.unsound([&](const auto& pair) {
    return convention.motion(pair.pair) ? std::optional(evidence.given_motion(pair)) : std::nullopt;
  });
  score.median_misfit = median(std::move(misfits));
  judge(evidence, convention, score);
  return score;
}

std::optional<std::size_t> best_convention(const std::vector<ConventionScore>& scores) {
  const std::vector<std::size_t> better = better_ones(scores);
  return better.empty() ? std::nullopt : std::optional(better.front());
}

Remedy remedy_of(const PoseEvidence& poses) {
  std::vector<std::size_t> better = as_good_as_the_best(poses.scores);
  std::erase_if(better, [&](std::size_t i) { return !poses.conventions[i].remedy; });
  return better.size() == 1 ? poses.conventions[better.front()].remedy : Remedy();
}

PoseEvidence measure_poses(const Sequence& sequence, const std::vector<Pose>& given,
                           const std::vector<PoseConvention>& conventions,
                           std::optional<double> step_s, Facts& facts) {
  constexpr std::size_t kSpots = 6;
  std::vector<std::size_t> spots = odd_steps(given, kSpots);
  for (const RowRange& run : equal_rows(given)) {
    if (spots.size() < 2 * kSpots) spots.push_back((run.first + run.last) / 2);
  }
  PoseEvidence poses;
  poses.given = given;
  for (const ScanEntry& scan : sequence.recording().scans) poses.stems.push_back(scan.stem);
  poses.measured = measure_motions(sequence, given, spots, {});
  compare(poses, conventions);
  if (const auto guesses = worth_another_try(poses); !guesses.empty()) {
    poses.measured = measure_motions(sequence, given, spots, guesses);
    compare(poses, conventions);
  }
  tell(poses, step_s, facts);
  return poses;
}

}  // namespace mosbench
