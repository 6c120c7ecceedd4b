#include "datasets/doctor/convention_scores.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mosbench {
namespace {

/// The same as kLeastGain on average where a convention differs from the given poses.
constexpr double kLeastMeanGain = 0.25;
/// The same of conventions that claim less motion: where nothing holds a scan along a corridor,
/// registration makes motions shorter, with a gain of 0.35; feet on a highway gain 3.6.
constexpr double kLeastMeanGainOfRest = 1.0;
constexpr std::size_t kFewestTellingPairs = 3, kFewestShiftPairs = 6;
/// Differences of log likelihood below show nothing.
constexpr double kTelling = 0.2;
/// Conventions within this share of the best gain are as good.
constexpr double kSameShare = 0.9;
constexpr std::size_t kMostTries = 4;
/// It has to gain more then: shifts over a straight road at one speed all fit most motions.
constexpr double kClearGain = 2.0 * kLeastGain;
/// A convention explains motions of which many are measured wrongly when it leaves at most this
/// share of the deviation.
constexpr double kExplainedShare = 0.5;
/// The same of shifted rows. Right ones left 0.71 (highway) and less where the measured motions
/// agree, one beside a reversed block of rows 0.99.
constexpr double kExplainedShareOfRows = 0.85;

/// Returns the conventions that are better, best first.
std::vector<std::size_t> better_ones(const std::vector<ConventionScore>& scores) {
  std::vector<std::size_t> better;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i].is_better) better.push_back(i);
  }
  std::ranges::sort(better, std::ranges::greater(), [&](std::size_t i) { return scores[i].gain; });
  return better;
}

/// Returns the conventions that explain the measured motions about as well as the best one; none
/// where that one does not.
std::vector<std::size_t> as_good_as_the_best(const std::vector<ConventionScore>& scores) {
  std::vector<std::size_t> better = better_ones(scores);
  if (better.empty() || !scores[better.front()].explains) return {};
  const double enough = kSameShare * scores[better.front()].gain;
  std::erase_if(better,
                [&](std::size_t i) { return !scores[i].explains || scores[i].gain < enough; });
  return better;
}

/// Returns "as one row later" or "with the points mirrored".
std::string reading_of(const PoseConvention& convention) {
  const std::string& name = convention.name;
  if (name.starts_with("with ") || name.starts_with("in ")) return name;
  return (name.starts_with("of ") ? "as poses " : "as ") + name;
}

std::string sentence_on(const std::vector<PoseConvention>& conventions,
                        const ConventionScore& score, const std::vector<std::size_t>& better) {
  const std::string off = fmt::format(
      "they are off the motion of the scans by {:.2f} m instead of {:.2f} m (median of {})",
      score.off_m, score.given_off_m, score.pairs);
  const PoseConvention& best = conventions[better.front()];
  if (better.size() == 1) {
    return fmt::format("the poses fit better {}: {}; {}", reading_of(best), off, best.remedy);
  }
  std::vector<std::string> names;
  for (const std::size_t i : better) names.push_back(reading_of(conventions[i]));
  return fmt::format(
      "the poses fit better {} (which of these cannot be told from these scans): {}; expected "
      "poses that fit as given",
      fmt::join(names, " or "), off);
}

}  // namespace

double noise_of_poses(const PoseEvidence& evidence,
                      const std::vector<PoseConvention>& conventions) {
  double noise = evidence.median_over(
      [&](const auto& pair) { return pair.misfit(evidence.given_motion(pair)).both(); });
  for (const PoseConvention& convention : conventions) {
    std::vector<double> misfits;
    for (const MeasuredMotion& pair : evidence.pairs) {
      const auto claimed = convention.motion(pair.pair);
      if (claimed) misfits.push_back(pair.misfit(*claimed).both());
    }
    if (2 * misfits.size() > evidence.pairs.size()) noise = std::min(noise, median(misfits));
  }
  return std::max(noise, 1.0);
}

ConventionScore score_of(const PoseEvidence& evidence, const PoseConvention& convention) {
  ConventionScore score;
  std::vector<double> off_m, given_off_m, misfits;
  for (const MeasuredMotion& pair : evidence.pairs) {
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
  return score;
}

std::map<std::string, double> convention_measures(const std::vector<ConventionScore>& scores) {
  const auto best = std::ranges::max_element(scores, {}, &ConventionScore::gain);
  if (best == scores.end()) return {};
  const double pairs = static_cast<double>(std::max<std::size_t>(best->pairs, 1));
  return {{"gain", best->gain},
          {"mean_gain", best->gain / pairs},
          {"explained_misfit", best->median_misfit},
          {"explained_unsound", best->unsound}};
}

double best_gain(const std::vector<ConventionScore>& scores) {
  const std::vector<std::size_t> better = better_ones(scores);
  return better.empty() ? 0.0 : scores[better.front()].gain;
}

std::optional<std::string> better_convention(const std::vector<PoseConvention>& conventions,
                                             const std::vector<ConventionScore>& scores) {
  const std::vector<std::size_t> better = as_good_as_the_best(scores);
  if (better.empty()) return std::nullopt;
  return sentence_on(conventions, scores[better.front()], better);
}

std::string flags_for(const std::vector<PoseConvention>& conventions,
                      const std::vector<ConventionScore>& scores) {
  constexpr std::string_view kByFlags = "run with ";
  std::vector<std::size_t> better = as_good_as_the_best(scores);
  std::erase_if(better,
                [&](std::size_t i) { return !conventions[i].remedy.starts_with(kByFlags); });
  return better.size() == 1 ? conventions[better.front()].remedy.substr(kByFlags.size()) : "";
}

std::vector<PoseConvention> worth_another_try(const std::vector<PoseConvention>& conventions,
                                              const std::vector<ConventionScore>& scores) {
  std::vector<std::size_t> better = better_ones(scores);
  if (better.empty() || scores[better.front()].explains) return {};
  better.resize(std::min(better.size(), kMostTries));
  std::vector<PoseConvention> tries;
  for (const std::size_t i : better) tries.push_back(conventions[i]);
  return tries;
}

}  // namespace mosbench
