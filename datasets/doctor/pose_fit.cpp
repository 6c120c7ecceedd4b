#include "datasets/doctor/pose_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "datasets/doctor/doctor.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Scans apart: drift adds up over many, jitter shows from scan to scan.
constexpr std::array<std::size_t, 3> kApart = {20, 5, 1};
/// Farther on, scans may share no more than the traffic that they move with.
constexpr double kMostApartM = 30.0;
constexpr std::size_t kMostPlaces = 12;
/// One place per so many scans costs a run little. Two places say too little.
constexpr std::size_t kScansPerPlace = 15, kFewestPlaces = 3;
/// Of a scan; more do not match better. No multiples of a sensor's rows, all of which are picked.
constexpr std::size_t kPoints = 30011, kPointsInBrief = 15013;
constexpr double kFitCellM = 1.0;

// Sound poses of KITTI and of simulated drives, walks and rosettes were off by 1.6 cm at 10 m and
// 2.1 cm at 30 m at most (median over 20 scans), with 2 cm of noise by 4; with 1 % of drift, where
// a vehicle moves, by 4.1 cm and more.
constexpr double kOff10M = 0.04, kOff30M = 0.08;
constexpr double kFarOff = 2.5;  // times as much
/// Of a single step, which an irregular clock makes stand out, too. Sound ones of sparse scans that
/// scan matching took for standing were off by 0.55 m (simulated Avia), and overlapped as well.
constexpr double kJump = 5.0, kOverlapOfJump = 2.0;
/// Poses that are farther off are better found anew than refined.
constexpr double kMostRefined_cm = 50.0;
/// The given motion is off by so many times the error of scan matching.
constexpr double kClearly = 3.0;
/// Scan matching that errs more, or finds less overlap, tells nothing.
constexpr double kMostError10M = 0.05, kMostError30M = 0.1, kLeastOverlap = 0.1;
/// Poses that are off by this share already from scan to scan do not drift.
constexpr double kJitterShare = 0.5;

/// How far two motions put surfaces apart along their normals, root mean square, metres. Directions
/// in which no surface holds a scan do not count.
struct Offset {
  double at_10_m = 0.0, at_30_m = 0.0;  ///< of surfaces so far from the sensor
};

/// How two scans fit, beside what scan matching reaches.
struct PairFit {
  ScanPair pair;
  Pose motion;     ///< that scan matching finds
  Offset given;    ///< of the given motion from the one that scan matching finds
  Offset matched;  ///< of scan matching there from scan matching back: what it errs by
  double overlap = 0.0, given_overlap = 0.0;

  bool is_off(double times = 1.0) const {
    return given.at_10_m > std::max(times * kOff10M, kClearly * matched.at_10_m) ||
           given.at_30_m > std::max(times * kOff30M, kClearly * matched.at_30_m);
  }
  bool overlaps_clearly_better() const { return overlap > kOverlapOfJump * given_overlap; }
};

/// The pairs of a place that scan matching can tell, the farthest scans first.
using Place = std::vector<PairFit>;

/// Returns nothing where scans share too few surfaces.
std::optional<Offset> offset(const RegisteredScan& earlier, const RegisteredScan& later,
                             const Pose& motion, const Pose& matched) {
  constexpr double kFewest = 30.0, kBesideM = 0.2, kThickestM2 = 0.1 * 0.1;
  double squares_10_m2 = 0.0, squares_30_m2 = 0.0, count = 0.0;
  const auto add = [&](const Eigen::Vector3d& point_m) {
    const auto* surface = earlier.surface_at(matched * point_m);
    if (surface == nullptr || !surface->is_plane() || surface->variance_m2[0] > kThickestM2) return;
    const Eigen::Vector3d normal = surface->directions.col(0);
    if (std::abs(normal.dot(matched * point_m - surface->mean_m)) > kBesideM) return;
    const auto squared = [&](double range_m) {
      const Eigen::Vector3d there_m = range_m * point_m.normalized();
      const double apart_m = normal.dot(motion * there_m - matched * there_m);
      return apart_m * apart_m;
    };
    squares_10_m2 += squared(10.0);
    squares_30_m2 += squared(30.0);
    count += 1.0;
  };
  std::ranges::for_each(later.upright_m, add);
  std::ranges::for_each(later.ground_m, add);
  if (count < kFewest) return std::nullopt;
  return Offset{std::sqrt(squares_10_m2 / count), std::sqrt(squares_30_m2 / count)};
}

/// Matches scans from a start. Returns nothing where scan matching does not tell.
std::optional<PairFit> fit_from(const Pose& start, const RegisteredScan& earlier,
                                const RegisteredScan& later, const ScanPair& pair,
                                const Pose& given) {
  const Registration there = registered(earlier, later, start);
  const Registration back = registered(later, earlier, start.inverse());
  const auto off = offset(earlier, later, given, there.motion);
  const auto error = offset(earlier, later, back.motion.inverse(), there.motion);
  const bool tells = off && error && there.overlap > kLeastOverlap &&
                     error->at_10_m < kMostError10M && error->at_30_m < kMostError30M;
  if (!tells) return std::nullopt;
  return PairFit{pair,   there.motion,  *off,
                 *error, there.overlap, upright_overlap(earlier, later, given)};
}

/// The same from the given motion, and near standing for scans one or two apart: the worst poses
/// are too far off to match scans from there.
std::optional<PairFit> fit_of(const RegisteredScan& earlier, const RegisteredScan& later,
                              const ScanPair& pair, const Pose& given) {
  auto fit = fit_from(given, earlier, later, pair, given);
  if (fit || pair.later > pair.earlier + 2) return fit;
  fit = fit_from(Pose::Identity(), earlier, later, pair, given);
  return fit && fit->overlaps_clearly_better() ? fit : std::nullopt;
}

RegisteredScan scan_to_match(const Sequence& sequence, std::size_t scan_index, FitDetail detail) {
  const std::vector<Point> points = sequence.read(scan_index).points;
  return {picked(points, detail == FitDetail::kBrief ? kPointsInBrief : kPoints), kFitCellM};
}

std::vector<Place> measured_places(const Sequence& sequence, const std::vector<Pose>& given,
                                   FitDetail detail) {
  const bool brief = detail == FitDetail::kBrief;
  std::vector<Place> places;
  constexpr std::size_t kFewestScans = 5;
  if (given.size() < kFewestScans) return places;
  const std::size_t scans = given.size(), farthest = std::min(kApart.front(), (scans - 1) / 2);
  const std::size_t most = brief ? scans / kScansPerPlace : scans - farthest;
  const std::size_t count = std::clamp(most, kFewestPlaces, kMostPlaces);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i * (scans - 1 - farthest) / (count - 1);
    const RegisteredScan earlier = scan_to_match(sequence, first, detail);
    Place place;
    for (const std::size_t apart : kApart) {
      const ScanPair pair{first, first + std::min(apart, farthest)};
      if (!place.empty() && (brief || place.back().pair.later == pair.later)) continue;
      const Pose motion = relative(given, pair);
      if (apart > 1 && motion.translation().norm() > kMostApartM) continue;
      const RegisteredScan later = scan_to_match(sequence, pair.later, detail);
      const auto fit = fit_of(earlier, later, pair, motion);
      if (fit) place.push_back(*fit);
    }
    if (!place.empty()) places.push_back(std::move(place));
  }
  return places;
}

/// Returns the median over the places, in centimetres.
template <typename Value>
double median_cm(const std::vector<Place>& places, Value&& value_m) {
  std::vector<double> values_m;
  for (const Place& place : places) values_m.push_back(value_m(place));
  return 100.0 * median(std::move(values_m));
}

const char* kind_of(const Facts& facts, FitDetail detail) {
  if (detail == FitDetail::kBrief) return "do not fit the scans";
  if (*facts.number("off_share") <= kMostlyOff)
    return "do not fit in {off_places} of {places} places";
  const bool jitter = *facts.number("step_fit_cm") > kJitterShare * *facts.number("fit_10_cm");
  return jitter ? "jitter from scan to scan" : "drift";
}

/// Returns the steps of the poses that stand out most, also with the one before: a scan during
/// which the poses jump is undistorted by the jump, and fits both sides.
std::vector<ScanPair> odd_pairs(const std::vector<Pose>& given) {
  constexpr std::size_t kMostSteps = 3;
  constexpr double kLeastOddM = 0.15;  // no vehicle changes its step by more
  std::vector<ScanPair> pairs;
  for (const std::size_t row : odd_steps(given, kMostSteps, kLeastOddM)) {
    pairs.push_back({row - 1, row});
    if (row > 1) pairs.push_back({row - 2, row});
  }
  return pairs;
}

/// Returns a sentence for poses that make another step than the scans.
std::optional<std::string> doubt_about_steps(const Sequence& sequence,
                                             const std::vector<Pose>& given) {
  for (const ScanPair& pair : odd_pairs(given)) {
    const auto fit =
        fit_of(scan_to_match(sequence, pair.earlier, FitDetail::kBrief),
               scan_to_match(sequence, pair.later, FitDetail::kBrief), pair, relative(given, pair));
    if (!fit || !fit->is_off(kJump) || !fit->overlaps_clearly_better()) continue;
    return fmt::format(
        "the poses jump between scans {} and {}: they move by {:.2f} m, the scans by {:.2f} m, and "
        "surfaces 10 m away are {:.2f} m off; expected the same",
        sequence.stem(pair.earlier), sequence.stem(pair.later),
        relative(given, pair).translation().norm(), fit->motion.translation().norm(),
        fit->given.at_10_m);
  }
  return std::nullopt;
}

}  // namespace

void examine_pose_fit(const Sequence& sequence, const std::vector<Pose>& given, FitDetail detail,
                      Facts& facts) {
  const std::vector<Place> places = measured_places(sequence, given, detail);
  if (places.empty()) return;
  const auto off = [&](double times) {
    return static_cast<std::size_t>(std::ranges::count_if(
        places, [&](const Place& place) { return place.front().is_off(times); }));
  };
  const auto off_m = [](const Place& place) { return place.front().given.at_10_m; };
  const PairFit& worst = std::ranges::max_element(places, {}, off_m)->front();
  facts["places"] = places.size();
  facts["off_places"] = off(1.0);
  facts["off_share"] = share(off(1.0), places.size());
  facts["far_off_places"] = off(kFarOff);
  facts["fit_10_cm"] = median_cm(places, off_m);
  facts["fit_30_cm"] =
      median_cm(places, [](const auto& place) { return place.front().given.at_30_m; });
  facts["match_cm"] =
      median_cm(places, [](const auto& place) { return place.front().matched.at_10_m; });
  facts["step_fit_cm"] =
      median_cm(places, [](const auto& place) { return place.back().given.at_10_m; });
  facts["fit_scans"] = counted(worst.pair.later - worst.pair.earlier, "scan");
  facts["worst_fit_cm"] = 100.0 * worst.given.at_10_m;
  facts["worst_fit"] = fmt::format("scan {} to {}", sequence.stem(worst.pair.earlier),
                                   sequence.stem(worst.pair.later));
  facts["most_off_cm"] = 100.0 * kOff10M;
  facts["pose_fit_kind"] = facts.told(kind_of(facts, detail));
  const ReadingDone& reading = sequence.reading();
  const bool can_refine = reading.poses.source != kStaticPoses && !reading.poses.refined &&
                          *facts.number("fit_10_cm") < kMostRefined_cm;
  facts["cure"] = can_refine ? option("refine_poses") : option("odometry", "simple");
}

std::optional<std::string> doubt_about_pose_fit(const Sequence& sequence) {
  const ReadingDone& reading = sequence.reading();
  if (reading.poses.source.empty() || reading.perturb) return std::nullopt;
  Facts facts;
  const std::vector<Pose> given = poses_of(sequence);
  examine_pose_fit(sequence, given, FitDetail::kBrief, facts);
  const auto found = judged(checks(), Subject::kFit, facts, sequence.name());
  return found.empty() ? doubt_about_steps(sequence, given) : std::optional(found.front().what);
}

}  // namespace mosbench
