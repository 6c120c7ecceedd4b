#include "datasets/doctor/measured_motions.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <deque>
#include <set>

namespace mosbench {
namespace {

constexpr double kRadOfDeg = M_PI / 180.0;
/// The deviation of a registration is larger than its curvature says, since neighbouring points err
/// alike.
constexpr double kCovarianceFactor = 9.0;
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
constexpr double kSearchedM = 4.0;

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

struct ScanInStretch {
  std::size_t index = 0;
  RegisteredScan scan;
  Pose start_from_scan = Pose::Identity();  ///< by motions that were taken
  Pose back_start_from_scan = Pose::Identity();
  Pose best_start_from_scan = Pose::Identity();
};

void take(MeasuredMotion& measured, const Registration& registration) {
  measured.motion = registration.motion;
  measured.overlap = registration.overlap;
  measured.covariance = kCovarianceFactor * registration.covariance;
}

void take(MeasuredMotion& measured, const OtherMotion& other) {
  take(measured, other.registration);
  measured.chained = other.chained;
}

template <typename OverlapOf>
double sum_over(const std::vector<MeasuredMotion>& pairs, OverlapOf&& overlap_of) {
  double sum = 0.0;
  for (const MeasuredMotion& pair : pairs) sum += overlap_of(pair);
  return sum;
}

double taken_overlap(const std::vector<MeasuredMotion>& pairs) {
  return sum_over(pairs, [](const auto& pair) { return pair.overlap; });
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
  const double back =
      sum_over(pairs, [](const auto& pair) { return pair.back.registration.overlap; });
  if (!(mean > kBackwardsErrors * error) || back < taken_overlap(pairs)) return;
  for (MeasuredMotion& pair : pairs) take(pair, pair.back);
}

/// Takes the best registrations where they are clearly better on the whole, if not one by one.
void take_best(std::vector<MeasuredMotion>& pairs) {
  const double best =
      sum_over(pairs, [](const auto& pair) { return pair.best.registration.overlap; });
  if (best <= kBetterOnTheWhole * taken_overlap(pairs)) return;
  for (MeasuredMotion& pair : pairs) take(pair, pair.best);
}

class StretchMeasuring {
 public:
  StretchMeasuring(const Sequence& sequence, const std::vector<Pose>& given, double cell_m,
                   const std::vector<MotionGuess>& guesses, std::vector<MeasuredMotion>& pairs)
      : sequence_(sequence), given_(given), cell_m_(cell_m), guesses_(guesses), pairs_(pairs) {}

  void measure(const Stretch& stretch) {
    for (std::size_t k = stretch.first; k < stretch.second; ++k) {
      ScanInStretch next{k, registered_scan(sequence_.read(k).points, cell_m_)};
      if (!window_.empty()) measure_step(next);
      window_.push_back(std::move(next));
      if (window_.size() > kMostApart) window_.pop_front();
    }
  }

 private:
  void measure_step(ScanInStretch& next) {
    const ScanInStretch& before = window_.back();
    MeasuredMotion step = between(before, next, {last_step_, Pose::Identity()}, !have_step_);
    next.start_from_scan = before.start_from_scan * step.motion;
    next.back_start_from_scan = before.back_start_from_scan * step.back.registration.motion;
    next.best_start_from_scan = before.best_start_from_scan * step.best.registration.motion;
    last_step_ = step.best.registration.motion;
    have_step_ = step.best.registration.overlap > 0.0;
    pairs_.push_back(std::move(step));
    const ScanInStretch& far = far_before(next);
    if (far.index + 1 == next.index || next.index % 2 == 1) return;
    const Pose chained = far.start_from_scan.inverse() * next.start_from_scan;
    const Pose best_chained = far.best_start_from_scan.inverse() * next.best_start_from_scan;
    pairs_.push_back(between(far, next, {chained, best_chained}, false));
    pairs_.back().chained = chained;
    pairs_.back().back.chained = far.back_start_from_scan.inverse() * next.back_start_from_scan;
    pairs_.back().best.chained = best_chained;
  }

  /// Returns the last scan that is at least two scans and some metres before: two ways across each
  /// step tell a jump of the poses from a step that was measured wrongly.
  const ScanInStretch& far_before(const ScanInStretch& next) const {
    for (std::size_t i = window_.size() - 1; i-- > 0;) {
      const Pose motion = window_[i].start_from_scan.inverse() * next.start_from_scan;
      if (motion.translation().norm() >= kFarApartM) return window_[i];
    }
    return window_.front();
  }

  MeasuredMotion between(const ScanInStretch& earlier, const ScanInStretch& later,
                         const std::vector<Pose>& starts, bool search) const {
    const HoldingSurfaces& surfaces = earlier.scan.surfaces;
    const SparseScan& points = later.scan.points;
    MeasuredMotion measured;
    measured.pair = {earlier.index, later.index};
    const Pose given = relative(given_, measured.pair);
    measured.given_overlap = upright_overlap(surfaces, points, given);
    const Registration from_given = registered(surfaces, points, given);
    take(measured, from_given);
    measured.best.registration = from_given;
    const auto consider = [&](const Pose& start) {
      const Registration other = registered(surfaces, points, start);
      const bool near = difference_m(other.motion, from_given.motion) < kNearM;
      const double enough = near ? 0.0 : kClearlyBetter * from_given.overlap;
      if (other.overlap > std::max(enough, measured.overlap)) take(measured, other);
      if (other.overlap > measured.best.registration.overlap) measured.best.registration = other;
    };
    for (const Pose& start : starts) consider(start);
    for (const MotionGuess& guess : guesses_) {
      if (const auto start = guess(measured.pair)) consider(*start);
    }
    if (search) consider(searched_start(surfaces, points, kSearchedM));
    const Pose back = given.inverse();
    measured.back_overlap = upright_overlap(surfaces, points, back);
    measured.back.registration = registered(surfaces, points, back);
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
