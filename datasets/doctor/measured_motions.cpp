#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <deque>
#include <set>

#include "datasets/doctor/pose_evidence.hpp"

namespace mosbench {
namespace {

constexpr double kRadOfDeg = M_PI / 180.0;
/// Best accuracy of a registration.
constexpr double kFinestM = 0.01, kFinestRad = 0.05 * kRadOfDeg;
/// Deviation per axis of poses that are still sound.
constexpr double kSoundNoiseM = 0.05, kSoundNoiseRad = 0.1 * kRadOfDeg;
/// Another motion than the given has to overlap so many times better to be believed: on a road with
/// traffic scans overlap nearly as well as if the sensor stood.
constexpr double kClearlyBetter = 1.5;
/// One nearer than that is the same place, found better.
constexpr double kNearM = 0.5;
/// The same for the sum over a sequence.
constexpr double kBetterOnTheWhole = 1.2;
/// Scans of a straight road overlap nearly as well under inverse motions. Over a sequence one of
/// the two is better: by so many standard errors of the mean difference.
constexpr double kBackwardsErrors = 3.0;

constexpr std::size_t kMostScans = 100;
constexpr std::size_t kStretches = 5;
constexpr std::size_t kSpotBefore = 3, kSpotAfter = 3;
constexpr std::size_t kMostApart = 8;
constexpr double kFarApartM = 2.0;

using Stretch = std::pair<std::size_t, std::size_t>;  // [first, last)

std::vector<Stretch> stretches_of(std::size_t scans, const std::vector<std::size_t>& spots) {
  if (scans <= kMostScans) return {{0, scans}};
  std::set<std::size_t> measured;
  const std::size_t length = kMostScans / kStretches;
  for (std::size_t i = 0; i < kStretches; ++i) {
    const std::size_t first = i * (scans - length) / (kStretches - 1);
    for (std::size_t k = 0; k < length; ++k) measured.insert(first + k);
  }
  for (const std::size_t spot : spots) {
    for (std::size_t k = spot < kSpotBefore ? 0 : spot - kSpotBefore;
         k < std::min(spot + kSpotAfter, scans); ++k) {
      measured.insert(k);
    }
  }
  std::vector<Stretch> stretches;
  for (const std::size_t k : measured) {
    if (stretches.empty() || stretches.back().second != k) stretches.emplace_back(k, k);
    stretches.back().second = k + 1;
  }
  return stretches;
}

/// The motions that are followed from scan to scan: that taken, and two that may be taken instead.
constexpr std::array<ShownMotion& (*)(MeasuredMotion&), 3> kFollowed = {
    [](MeasuredMotion& motion) -> ShownMotion& { return motion; },
    [](MeasuredMotion& motion) -> ShownMotion& { return motion.back; },
    [](MeasuredMotion& motion) -> ShownMotion& { return motion.best; }};

struct ScanInStretch {
  std::size_t index = 0;
  RegisteredScan scan;
  std::array<Pose, 3> start_from_scan = {Pose::Identity(), Pose::Identity(), Pose::Identity()};
};

template <typename Value>
double sum_over(const std::vector<MeasuredMotion>& pairs, Value&& value) {
  double sum = 0.0;
  for (const MeasuredMotion& pair : pairs) sum += value(pair);
  return sum;
}

double taken_overlap(const std::vector<MeasuredMotion>& pairs) {
  return sum_over(pairs, [](const auto& pair) { return pair.overlap; });
}

void take(std::vector<MeasuredMotion>& pairs, ShownMotion MeasuredMotion::*other) {
  for (MeasuredMotion& pair : pairs) static_cast<ShownMotion&>(pair) = pair.*other;
}

/// Takes the registrations the other way round where they are better on the whole, by more than
/// chance: poses are inverse all together or not. One by one, pairs of a straight road mislead.
void take_backwards(std::vector<MeasuredMotion>& pairs) {
  const auto better = [](const auto& pair) { return pair.back_overlap - pair.given_overlap; };
  const double count = static_cast<double>(pairs.size());
  const double mean = sum_over(pairs, better) / count;
  const double squares =
      sum_over(pairs, [&](const auto& pair) { return better(pair) * better(pair); });
  const double error = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
  const double back = sum_over(pairs, [](const auto& pair) { return pair.back.overlap; });
  if (mean > kBackwardsErrors * error && back >= taken_overlap(pairs)) {
    take(pairs, &MeasuredMotion::back);
  }
}

/// Takes the best registrations where they are clearly better on the whole, if not one by one.
void take_best(std::vector<MeasuredMotion>& pairs) {
  const double best = sum_over(pairs, [](const auto& pair) { return pair.best.overlap; });
  if (best > kBetterOnTheWhole * taken_overlap(pairs)) take(pairs, &MeasuredMotion::best);
}

class StretchMeasuring {
 public:
  StretchMeasuring(const Sequence& sequence, const std::vector<Pose>& given, double cell_m,
                   const std::vector<MotionGuess>& guesses, std::vector<MeasuredMotion>& pairs)
      : sequence_(sequence), given_(given), cell_m_(cell_m), guesses_(guesses), pairs_(pairs) {}

  void measure(const Stretch& stretch) {
    for (std::size_t k = stretch.first; k < stretch.second; ++k) {
      ScanInStretch next{k, RegisteredScan(sequence_.read(k).points, cell_m_)};
      if (!window_.empty()) measure_step(next);
      window_.push_back(std::move(next));
      if (window_.size() > kMostApart) window_.pop_front();
    }
  }

 private:
  void measure_step(ScanInStretch& next) {
    const ScanInStretch& before = window_.back();
    MeasuredMotion step = between(before, next, {last_step_, Pose::Identity()}, !have_step_);
    for (std::size_t i = 0; i < kFollowed.size(); ++i) {
      next.start_from_scan[i] = before.start_from_scan[i] * kFollowed[i](step).motion;
    }
    last_step_ = step.best.motion;
    have_step_ = step.best.overlap > 0.0;
    pairs_.push_back(std::move(step));
    const ScanInStretch& far = far_before(next);
    if (far.index + 1 == next.index || next.index % 2 == 1) return;
    std::array<Pose, 3> chained;
    for (std::size_t i = 0; i < kFollowed.size(); ++i) {
      chained[i] = far.start_from_scan[i].inverse() * next.start_from_scan[i];
    }
    MeasuredMotion& across =
        pairs_.emplace_back(between(far, next, {chained.front(), chained.back()}, false));
    for (std::size_t i = 0; i < kFollowed.size(); ++i) kFollowed[i](across).chained = chained[i];
  }

  /// Returns the last scan that is at least two scans and some metres before: two ways across each
  /// step tell a jump of the poses from a step that was measured wrongly.
  const ScanInStretch& far_before(const ScanInStretch& next) const {
    for (std::size_t i = window_.size() - 1; i-- > 0;) {
      const Pose motion =
          window_[i].start_from_scan.front().inverse() * next.start_from_scan.front();
      if (motion.translation().norm() >= kFarApartM) return window_[i];
    }
    return window_.front();
  }

  MeasuredMotion between(const ScanInStretch& earlier, const ScanInStretch& later,
                         const std::vector<Pose>& starts, bool search) const {
    MeasuredMotion measured;
    measured.pair = {earlier.index, later.index};
    const Pose given = relative(given_, measured.pair);
    measured.given_overlap = upright_overlap(earlier.scan, later.scan, given);
    const Registration from_given = registered(earlier.scan, later.scan, given);
    Registration& taken = measured;
    Registration& best = measured.best;
    taken = best = from_given;
    const auto consider = [&](const Pose& start) {
      const Registration other = registered(earlier.scan, later.scan, start);
      const bool near = difference_m(other.motion, from_given.motion) < kNearM;
      const double enough = near ? 0.0 : kClearlyBetter * from_given.overlap;
      if (other.overlap > std::max(enough, taken.overlap)) taken = other;
      if (other.overlap > best.overlap) best = other;
    };
    for (const Pose& start : starts) consider(start);
    for (const MotionGuess& guess : guesses_) {
      if (const auto start = guess(measured.pair)) consider(*start);
    }
    if (search) consider(searched_start(earlier.scan, later.scan));
    const Pose back = given.inverse();
    measured.back_overlap = upright_overlap(earlier.scan, later.scan, back);
    static_cast<Registration&>(measured.back) = registered(earlier.scan, later.scan, back);
    return measured;
  }

  const Sequence& sequence_;
  const std::vector<Pose>& given_;
  double cell_m_;
  const std::vector<MotionGuess>& guesses_;
  std::vector<MeasuredMotion>& pairs_;
  std::deque<ScanInStretch> window_;
  Pose last_step_ = Pose::Identity();
  bool have_step_ = false;
};

/// Returns the size of cells in which scans of the sequence overlap better: sparse scans need
/// larger ones.
double cell_size_m(const Sequence& sequence, const std::vector<Pose>& given,
                   const std::vector<MotionGuess>& guesses) {
  constexpr std::size_t kTried = 4;
  double best_m = 0.0, best_overlap = -1.0;
  for (const double size_m : {1.0, 2.0}) {
    std::vector<double> overlaps;
    for (std::size_t i = 0; i < kTried; ++i) {
      std::vector<MeasuredMotion> pairs;
      const std::size_t first = i * (given.size() - 2) / (kTried - 1);
      StretchMeasuring(sequence, given, size_m, guesses, pairs).measure({first, first + 2});
      overlaps.push_back(pairs.front().overlap);
    }
    // Larger cells overlap a little better always.
    constexpr double kMuch = 1.3;
    const double overlap = median(overlaps);
    if (overlap <= kMuch * best_overlap) continue;
    best_overlap = overlap;
    best_m = size_m;
  }
  return best_m;
}

Misfit misfit_of(const MeasuredMotion& measured, const Pose& claimed, double noise_m,
                 double noise_rad) {
  const Eigen::Vector3d apart_m = claimed.translation() - measured.motion.translation();
  const Eigen::AngleAxisd turn(
      Eigen::Matrix3d(claimed.linear() * measured.motion.linear().transpose()));
  const Eigen::Vector3d apart_rad = turn.angle() * turn.axis();
  const auto squared = [](const Eigen::Vector3d& apart, const Eigen::Matrix3d& covariance,
                          double noise) {
    const Eigen::Matrix3d expected = covariance + noise * noise * Eigen::Matrix3d::Identity();
    return apart.dot(expected.inverse() * apart) / 3.0;
  };
  return {squared(apart_m, measured.covariance.topLeftCorner<3, 3>(), noise_m),
          squared(apart_rad, measured.covariance.bottomRightCorner<3, 3>(), noise_rad)};
}

}  // namespace

Misfit MeasuredMotion::misfit(const Pose& claimed) const {
  return misfit_of(*this, claimed, kFinestM, kFinestRad);
}

Misfit MeasuredMotion::unsound(const Pose& claimed) const {
  const double both = std::sqrt(2.0);  // poses err
  return misfit_of(*this, claimed, both * kSoundNoiseM, both * kSoundNoiseRad);
}

MeasuredMotions measure_motions(const Sequence& sequence, const std::vector<Pose>& given,
                                const std::vector<std::size_t>& spots,
                                const std::vector<MotionGuess>& guesses) {
  MeasuredMotions motions;
  const double cell_m = cell_size_m(sequence, given, guesses);
  for (const Stretch& stretch : stretches_of(given.size(), spots)) {
    StretchMeasuring(sequence, given, cell_m, guesses, motions.pairs).measure(stretch);
    motions.scans_read += stretch.second - stretch.first;
  }
  take_backwards(motions.pairs);
  take_best(motions.pairs);
  return motions;
}

}  // namespace mosbench
