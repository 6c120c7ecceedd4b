#include <deque>
#include <mosbench/pose_refiner.hpp>
#include <optional>
#include <utility>

#include "core/base/median.hpp"
#include "core/odometry/rigid_motion.hpp"
#include "core/odometry/surface_map.hpp"
#include "core/odometry/surface_registration.hpp"

namespace mosbench {
namespace {

using odometry::fit_m;
using odometry::moved_by;
using odometry::offset;
using odometry::Offset6;
using odometry::registered;
using odometry::rigid;
using odometry::SurfaceMap;
using odometry::SurfacePoints;

/// Scans apart whose fit decides: single steps hide a steady error.
constexpr std::size_t kApart = 10;
/// Registration always fits a little better than poses that are as good.
constexpr double kClearlyBetter = 0.9;
/// The given poses hold over stretches longer than this.
constexpr double kHolding_scans = 100.0;

/// Returns x with x[0] = 0 that minimises the sum of |x[k] - wanted[k]|^2 and, times the square of
/// kHolding_scans, |x[k] - x[k-1]|^2.
std::vector<Offset6> slowly_following(const std::vector<Offset6>& wanted) {
  constexpr double kStiff = kHolding_scans * kHolding_scans;
  const std::size_t size = wanted.size();
  std::vector<double> share(size, 0.0);
  std::vector<Offset6> x(size, Offset6::Zero());
  for (std::size_t k = 1; k < size; ++k) {
    const double last = k + 1 == size ? 0.0 : kStiff;
    const double pivot = 1.0 + kStiff + last - kStiff * share[k - 1];
    share[k] = kStiff / pivot;
    x[k] = (wanted[k] + kStiff * x[k - 1]) / pivot;
  }
  for (std::size_t k = size - 1; k-- > 1;) x[k] += share[k] * x[k + 1];
  return x;
}

/// Turns and moves registered poses slowly to where the given ones are.
std::vector<Pose> held_by(const std::vector<Pose>& given, std::vector<Pose> poses) {
  std::vector<Offset6> off;
  for (std::size_t k = 0; k < poses.size(); ++k) off.push_back(offset(given[k], poses[k]));
  const std::vector<Offset6> taken_back = slowly_following(off);
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k] = moved_by(poses[k], taken_back[k]);
  return poses;
}

}  // namespace

struct PoseRefiner::State {
  std::vector<Pose> pushed;        ///< map_from_sensor
  std::vector<Pose> given, found;  ///< first_from_sensor
  SurfaceMap map;
  std::deque<SurfaceMap> recent;  ///< of single scans
  std::vector<int> votes;         ///< of pairs of scans, for the motion found to each scan
  std::vector<std::size_t> failed;
  std::vector<double> given_fits_m, fits_m;

  void place(const SurfacePoints& scan);
  void compare(const SurfacePoints& scan);
};

/// Finds the pose of the last scan.
void PoseRefiner::State::place(const SurfacePoints& scan) {
  const std::size_t k = given.size() - 1;
  if (k == 0) return found.push_back(Pose::Identity());
  const Pose guess = rigid(found.back() * (given[k - 1].inverse() * given[k]));
  const std::optional<Pose> pose = registered(map, scan, guess);
  if (!pose) failed.push_back(k);
  found.push_back(pose.value_or(guess));
}

/// Compares the fit of the last scan to one before, as given and as found.
void PoseRefiner::State::compare(const SurfacePoints& scan) {
  if (recent.empty()) return;
  const std::size_t later = given.size() - 1, earlier = later - recent.size();
  const auto fit = [&](const std::vector<Pose>& poses) {
    return fit_m(recent.front(), scan, poses[earlier].inverse() * poses[later]);
  };
  const std::optional<double> as_given = fit(given), as_found = fit(found);
  if (!as_given || !as_found) return;
  const int vote = *as_found < kClearlyBetter * *as_given ? 1 : -1;
  for (std::size_t k = earlier + 1; k <= later; ++k) votes[k] += vote;
  given_fits_m.push_back(*as_given);
  fits_m.push_back(*as_found);
}

PoseRefiner::PoseRefiner() : state_(std::make_unique<State>()) {}
PoseRefiner::~PoseRefiner() = default;

void PoseRefiner::push(std::span<const Point> points, const Pose& given) {
  State& state = *state_;
  state.pushed.push_back(given);
  state.given.push_back(state.pushed.front().inverse() * given);
  state.votes.push_back(0);
  const SurfacePoints scan(points);
  state.place(scan);
  state.compare(scan);
  state.map.enter(scan.entered_m, state.found.back());
  if (state.recent.size() == kApart) state.recent.pop_front();
  state.recent.emplace_back().enter(scan.entered_m, Pose::Identity());
}

RefinedPoses PoseRefiner::finish() const {
  const State& state = *state_;
  const std::vector<Pose>& given = state.given;
  RefinedPoses refined{.map_from_sensor = state.pushed, .failed = state.failed};
  refined.given_fit_m = upper_median(state.given_fits_m);
  refined.fit_m = upper_median(state.fits_m);
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const bool corrects = state.votes[k] > 0;
    const std::vector<Pose>& by = corrects ? state.found : given;
    poses.push_back(k == 0 ? given[0] : rigid(poses.back() * (by[k - 1].inverse() * by[k])));
    refined.corrected += corrects ? 1 : 0;
  }
  if (refined.corrected == 0) return refined;
  poses = held_by(given, std::move(poses));
  for (std::size_t k = 1; k < poses.size(); ++k) {
    refined.map_from_sensor[k] = state.pushed.front() * poses[k];
  }
  return refined;
}

}  // namespace mosbench
