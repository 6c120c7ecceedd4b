#include "datasets/doctor/pose_measurement.hpp"

#include <algorithm>

#include "datasets/doctor/scan_overlap.hpp"

namespace mosbench {
namespace {

// The thresholds of a verdict were checked on 40 simulated scans each of street and highway
// (HDL-64E, VLP-16), campus (Avia, OS1-64), mall (OS1-64) and street (Aeva), with right poses and
// with ones stored inverted, transposed or shifted by a row. No convention beats right poses, and
// all wrong ones are named but those of the highway with the VLP-16, whose scans overlap too
// little.

/// Pairs of scans spread over the sequence on which poses are measured.
constexpr std::size_t kSpreadPairs = 8;
/// Pairs of scans on which a convention is compared with the given poses.
constexpr std::size_t kTellingPairs = 6;
/// The same for a shift by one row, which changes each motion little.
constexpr std::size_t kShiftPairs = 12;
/// Fewer pairs give no verdict: half of the above.
constexpr std::size_t kFewestTellingPairs = 3, kFewestShiftPairs = 6;
/// Share of the pairs that have to overlap better. All did under the right convention, at least
/// 11 of 12 under the right shift, and at most 4 of 12 under a wrong one next to right poses.
constexpr std::size_t kPairsBetter = 5, kOfPairs = 6;
/// Mean overlap that the right convention has to gain. It gained 0.028 or more (0.013 on the
/// highway with the VLP-16), while every other one lost 0.013 or more against right poses.
constexpr double kLeastConventionGain = 0.015;
/// The same for a shift: 0.006 or more, while a wrong one lost 0.003 or more.
constexpr double kLeastShiftGain = 0.003;
/// Conventions within this share of the best overlap are as good: these scans do not decide between
/// them.
constexpr double kSameShare = 0.97;

/// Returns a distance in scans at which scans are some metres apart, but still overlap.
std::size_t stride_of(const std::vector<Pose>& given) {
  constexpr double kFarM = 2.0;
  std::size_t stride = 1;
  for (const std::size_t candidate : {2U, 4U, 8U}) {
    if (candidate * 2 >= given.size()) break;
    std::vector<double> steps_m;
    for (std::size_t i = 0; i + candidate < given.size(); ++i) {
      steps_m.push_back(relative(given, {i, i + candidate}).translation().norm());
    }
    if (median(steps_m) > kFarM) break;
    stride = candidate;
  }
  return stride;
}

class Measuring {
 public:
  Measuring(const Sequence& sequence, const std::vector<Pose>& given,
            const std::vector<PoseConvention>& conventions)
      : given_(given), conventions_(conventions), scans_(sequence) {}

  std::optional<PoseMeasurement> run() {
    find_spread_pairs();
    if (spread_.size() < 2) return std::nullopt;
    result_.given = fit([this](const ScanPair& pair) { return relative(given_, pair); });
    for (const PoseConvention& convention : conventions_) measure(convention);
    find_better();
    result_.scans_read = scans_.scans_read();
    return result_;
  }

 private:
  void find_spread_pairs() {
    const std::size_t stride = stride_of(given_);
    const std::size_t last = given_.size() - stride;
    for (std::size_t i = 0; i < std::min(kSpreadPairs, last); ++i) {
      const std::size_t earlier = i * last / std::min(kSpreadPairs, last);
      const ScanPair pair{earlier, earlier + stride};
      if (!scans_.has_points(pair)) continue;
      spread_.push_back(pair);
      from_rest_.push_back(scans_.align_upright(pair, Pose::Identity()));
    }
  }

  template <typename MotionOf>
  PoseFit fit(MotionOf&& motion_of) {
    std::vector<double> overlaps, best, corrections_m;
    for (std::size_t i = 0; i < spread_.size(); ++i) {
      const Pose motion = motion_of(spread_[i]);
      const Alignment from_given = scans_.align_upright(spread_[i], motion);
      const Alignment& aligned =
          from_rest_[i].overlap > from_given.overlap ? from_rest_[i] : from_given;
      overlaps.push_back(scans_.upright_overlap(spread_[i], motion));
      best.push_back(aligned.overlap);
      corrections_m.push_back(difference_m(motion, aligned.cells_from_points));
    }
    return {median(overlaps), median(best), median(corrections_m)};
  }

  /// Returns the pairs where the convention differs most from the given poses, spread over the
  /// sequence. Scans further apart show more, as long as they overlap.
  std::vector<ScanPair> telling_pairs(const PoseConvention& convention) const {
    constexpr double kTellingM = 0.02, kFarM = 5.0;
    const std::size_t most = convention.shifts_rows ? kShiftPairs : kTellingPairs;
    // The row that stands for the one beyond the end shows nothing.
    const std::size_t from = convention.shifts_rows ? 1 : 0;
    std::vector<std::pair<double, ScanPair>> differences;
    for (const std::size_t stride : {1U, 2U, 4U, 8U, 16U}) {
      for (std::size_t i = from; i + stride + from < given_.size(); ++i) {
        const ScanPair pair{i, i + stride};
        const Pose given = relative(given_, pair), theirs = convention.motion(pair);
        if (stride > 1 && std::max(given.translation().norm(), theirs.translation().norm()) > kFarM)
          continue;
        const double apart_m = difference_m(given, theirs);
        if (apart_m > kTellingM) differences.emplace_back(apart_m, pair);
      }
    }
    std::ranges::sort(differences, std::ranges::greater(), &std::pair<double, ScanPair>::first);
    const std::size_t apart = std::max<std::size_t>(1, given_.size() / (2 * most));
    std::vector<ScanPair> pairs;
    for (const auto& [unused, pair] : differences) {
      const bool near = std::ranges::any_of(pairs, [&, i = pair.earlier](const ScanPair& chosen) {
        return std::max(chosen.earlier, i) - std::min(chosen.earlier, i) < apart;
      });
      if (!near) pairs.push_back(pair);
      if (pairs.size() == most) break;
    }
    return pairs;
  }

  void measure(const PoseConvention& convention) {
    ConventionScore& score = result_.scores.emplace_back();
    auto& pairs = telling_.emplace_back();
    for (const ScanPair& pair : telling_pairs(convention)) {
      if (!scans_.has_points(pair)) continue;
      const double given = scans_.overlap(pair, relative(given_, pair));
      const double other = scans_.overlap(pair, convention.motion(pair));
      pairs.push_back(pair);
      score.given_overlap += given;
      score.overlap += other;
      if (other > given) ++score.pairs_better;
    }
    score.pairs = pairs.size();
    if (pairs.empty()) return;
    score.given_overlap /= static_cast<double>(pairs.size());
    score.overlap /= static_cast<double>(pairs.size());
  }

  /// Returns whether a convention overlaps clearly better than the given poses.
  bool beats_given(std::size_t index) const {
    const bool shift = conventions_[index].shifts_rows;
    const ConventionScore& score = result_.scores[index];
    return score.pairs >= (shift ? kFewestShiftPairs : kFewestTellingPairs) &&
           kOfPairs * score.pairs_better >= kPairsBetter * score.pairs &&
           score.overlap > score.given_overlap + (shift ? kLeastShiftGain : kLeastConventionGain);
  }

  /// Collects, among the conventions that beat the given poses, those with the largest overlap on
  /// the telling pairs of all of them.
  void find_better() {
    std::vector<ScanPair> pairs;
    std::vector<std::pair<double, std::size_t>> candidates;
    for (std::size_t i = 0; i < conventions_.size(); ++i) {
      const auto motion = [&](const ScanPair& pair) { return conventions_[i].motion(pair); };
      if (!beats_given(i) || !fit(motion).fits()) continue;
      candidates.emplace_back(0.0, i);
      std::ranges::copy(telling_[i], std::back_inserter(pairs));
    }
    for (auto& [sum, i] : candidates) {
      for (const ScanPair& pair : pairs) sum += scans_.overlap(pair, conventions_[i].motion(pair));
    }
    std::ranges::sort(candidates, std::ranges::greater());
    for (const auto& [sum, i] : candidates) {
      if (sum >= kSameShare * candidates.front().first) result_.better.push_back(i);
    }
  }

  const std::vector<Pose>& given_;
  const std::vector<PoseConvention>& conventions_;
  ScanOverlap scans_;
  std::vector<ScanPair> spread_;
  std::vector<Alignment> from_rest_;            ///< per pair of spread_
  std::vector<std::vector<ScanPair>> telling_;  ///< per convention
  PoseMeasurement result_;
};

}  // namespace

bool PoseFit::fits() const {
  // Sparse scans can be aligned a little better than they were taken. Right poses had 0.97 of the
  // best overlap or more, with the Avia on the campus 0.8, with the VLP-16 on the highway 0.76;
  // inverted ones 0.6 or less, with the HDL-64E on the highway 0.76.
  constexpr double kFullShare = 0.75, kCorrectionM = 0.3;
  return overlap > kFullShare * best_overlap || median_correction_m < kCorrectionM;
}

std::optional<PoseMeasurement> measure_poses(const Sequence& sequence,
                                             const std::vector<Pose>& given,
                                             const std::vector<PoseConvention>& conventions) {
  constexpr std::size_t kFewestScans = 6;
  if (given.size() < kFewestScans) return std::nullopt;
  return Measuring(sequence, given, conventions).run();
}

}  // namespace mosbench
