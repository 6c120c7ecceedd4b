#include "datasets/sequence/pose_clock.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kMostWindows = 2, kMostScans = 10, kFewestScans = 4;
constexpr double kLongestWindow_s = 1.6, kFarthest_s = 1.2;
/// Sound poses gain less by another clock.
constexpr double kLeastGain = 0.15;
/// Farther apart than this the ends of a window have to be by another clock, to tell clocks.
constexpr double kTelling_m = 0.15;

/// What the scans show of the clock of poses that have stamps.
struct ClockFit {
  double off_s = 0.0;  ///< of the poses, by which the scans fit best
  double gain = 0.0;   ///< in the logarithm of the likelihood of a point
};

/// A scan as it was measured, and what leads from its pose at the stamp to that of its points.
struct WindowScan {
  std::int64_t stamp_ns;
  Pose stamp_from_points;
  std::vector<Eigen::Vector3d> points_m;
};
using Window = std::vector<WindowScan>;

std::vector<Eigen::Vector3d> some_points(std::span<const Point> points) {
  constexpr double kNearest_m = 1.5, kFarthest_m = 40.0;
  constexpr std::size_t kMostPoints = 1000;
  std::vector<Eigen::Vector3d> near_m;
  for (const Point& point : points) {
    const double range = range_m(point);
    if (range >= kNearest_m && range <= kFarthest_m) near_m.push_back(position_of(point));
  }
  const std::size_t step = 1 + near_m.size() / kMostPoints;
  std::vector<Eigen::Vector3d> some_m;
  for (std::size_t i = 0; i < near_m.size(); i += step) some_m.push_back(near_m[i]);
  return some_m;
}

constexpr double kCell_m = 2.0;

/// A key of the cell that holds a point within 2000 km.
std::int64_t cell_of(const Eigen::Vector3d& point_m) {
  std::int64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    key = (key << 21) + std::llround(std::clamp(point_m[axis] / kCell_m, -1e6, 1e6));
  }
  return key;
}

/// How far apart two motions put a point 10 m away.
double apart_m(const Pose& a, const Pose& b) {
  const Pose change = a.inverse() * b;
  return change.translation().norm() + 10.0 * Eigen::AngleAxisd(change.linear()).angle();
}

/// The thin side of the points in a cell.
struct Surface {
  std::size_t count = 0;
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares_m2 = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  double variance_m2 = 0.0;

  void finish() {
    constexpr double kUneven_m = 0.05;
    mean_m = sum_m / static_cast<double>(count);
    const Eigen::Matrix3d covariance =
        squares_m2 / static_cast<double>(count) - mean_m * mean_m.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
    normal = eigen.eigenvectors().col(0);
    variance_m2 = std::max(0.0, eigen.eigenvalues()[0]) + kUneven_m * kUneven_m;
  }
};

/// How likely points are by surfaces made of others, per point: the logarithm of a density along
/// the normals. Thick surfaces make it as small as points beside them.
class Likelihood {
 public:
  void add_surface_point(const Eigen::Vector3d& point_m) {
    Surface& surface = surfaces_[cell_of(point_m)];
    ++surface.count;
    surface.sum_m += point_m;
    surface.squares_m2 += point_m * point_m.transpose();
  }

  double of(const std::vector<Eigen::Vector3d>& points_m) {
    constexpr double kElsewhere = 0.1;  // share of points that lie anywhere in a cell
    std::erase_if(surfaces_, [](const auto& cell) { return cell.second.count < kFewest; });
    for (auto& [key, surface] : surfaces_) surface.finish();
    double sum = 0.0;
    for (const Eigen::Vector3d& point_m : points_m) {
      double density = kElsewhere / kCell_m;
      const auto cell = surfaces_.find(cell_of(point_m));
      if (cell != surfaces_.end()) {
        const Surface& surface = cell->second;
        const double off_m = surface.normal.dot(point_m - surface.mean_m);
        density += (1.0 - kElsewhere) * std::exp(-0.5 * off_m * off_m / surface.variance_m2) /
                   std::sqrt(2.0 * M_PI * surface.variance_m2);
      }
      sum += std::log(density);
    }
    return points_m.empty() ? 0.0 : sum / static_cast<double>(points_m.size());
  }

 private:
  static constexpr std::size_t kFewest = 5;
  std::unordered_map<std::int64_t, Surface> surfaces_;
};

class ClockFitting {
 public:
  ClockFitting(const Sequence& sequence, const PoseAt& pose_at)
      : sequence_(sequence), pose_at_(pose_at) {}

  std::optional<ClockFit> run() {
    for (const std::size_t first : telling_starts()) {
      Window window = window_at(first);
      if (window.size() >= kFewestScans) windows_.push_back(std::move(window));
    }
    if (windows_.empty()) return std::nullopt;
    std::array<ClockFit, 2> halves;
    for (std::size_t half = 0; half < halves.size(); ++half) {
      halves[half] = best_of(half);
      if (halves[half].gain < kLeastGain) return std::nullopt;
    }
    constexpr double kSame_s = 0.05;
    if (std::abs(halves[0].off_s - halves[1].off_s) > kSame_s) return std::nullopt;
    return ClockFit{0.5 * (halves[0].off_s + halves[1].off_s),
                    std::min(halves[0].gain, halves[1].gain)};
  }

 private:
  static std::int64_t ns_of(double time_s) { return std::llround(time_s * 1e9); }

  /// One past the last scan of a window.
  std::size_t end_of(std::size_t first) const {
    std::size_t end = first;
    while (end < sequence_.size() && sequence_.stamp_ns(end) && end - first < 2 * kMostScans &&
           1e-9 * static_cast<double>(*sequence_.stamp_ns(end) - *sequence_.stamp_ns(first)) <=
               kLongestWindow_s) {
      ++end;
    }
    return end;
  }

  /// How far the end of a window is from where another clock has it.
  double change_m(std::size_t first) const {
    constexpr double kTried_s = 0.1;
    const std::size_t end = end_of(first);
    if (end < first + kFewestScans) return 0.0;
    const auto motion = [&](double off_s) -> std::optional<Pose> {
      const auto from = pose_at_(*sequence_.stamp_ns(first) + ns_of(off_s));
      const auto to = pose_at_(*sequence_.stamp_ns(end - 1) + ns_of(off_s));
      if (!from || !to) return std::nullopt;
      return Pose(from->inverse() * *to);
    };
    const auto given = motion(0.0);
    double most_m = 0.0;
    for (const double off_s : {-kTried_s, kTried_s}) {
      const auto other = motion(off_s);
      if (given && other) most_m = std::max(most_m, apart_m(*given, *other));
    }
    return most_m;
  }

  /// The starts of the windows that tell most.
  std::vector<std::size_t> telling_starts() const {
    std::vector<std::pair<double, std::size_t>> starts;
    for (std::size_t first = 0; first + kFewestScans <= sequence_.size(); first += kMostScans) {
      if (const double change = change_m(first); change >= kTelling_m)
        starts.emplace_back(-change, first);
    }
    std::ranges::sort(starts);
    starts.resize(std::min(starts.size(), kMostWindows));
    std::vector<std::size_t> firsts;
    for (const auto& [change, first] : starts) firsts.push_back(first);
    return firsts;
  }

  Window window_at(std::size_t first) const {
    Window window;
    const std::size_t all = end_of(first) - first, step = (all + kMostScans - 1) / kMostScans;
    for (std::size_t k = first; k < first + all; k += std::max<std::size_t>(step, 1)) {
      Frame frame = sequence_.read(k);
      const std::int64_t stamp_ns = *sequence_.stamp_ns(k);
      const auto pose = pose_at_(stamp_ns);
      // Points that are moved later are moved here.
      if (!pose || (!frame.point_times_ns.empty() &&
                    !undistort(frame.points, frame.point_times_ns, stamp_ns, stamp_ns, pose_at_))) {
        continue;
      }
      window.push_back(
          {stamp_ns, pose->inverse() * frame.map_from_sensor, some_points(frame.points)});
    }
    return window;
  }

  /// The scans of a window that have poses by both clocks, by that moved by `off_s`.
  std::optional<double> score(const Window& window, std::size_t half, double known_s,
                              double off_s) const {
    Likelihood likelihood;
    std::vector<Eigen::Vector3d> compared_m;
    std::size_t scans = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
      const WindowScan& scan = window[i];
      if (!pose_at_(scan.stamp_ns + ns_of(known_s))) continue;
      const auto pose = pose_at_(scan.stamp_ns + ns_of(off_s));
      if (!pose) continue;
      ++scans;
      const Pose map_from_points = *pose * scan.stamp_from_points;
      for (const Eigen::Vector3d& point_m : scan.points_m) {
        const Eigen::Vector3d in_map_m = map_from_points * point_m;
        if (i % 2 == half) {
          likelihood.add_surface_point(in_map_m);
        } else {
          compared_m.push_back(in_map_m);
        }
      }
    }
    if (scans < std::max(kFewestScans, window.size() / 2)) return std::nullopt;
    return likelihood.of(compared_m);
  }

  /// By how much a clock fits better than the given one.
  std::optional<double> gain_of(std::size_t half, double off_s) const {
    double sum = 0.0;
    std::size_t windows = 0;
    for (const Window& window : windows_) {
      const auto moved = score(window, half, 0.0, off_s), given = score(window, half, off_s, 0.0);
      if (!moved || !given) continue;
      sum += *moved - *given;
      ++windows;
    }
    if (2 * windows < windows_.size() || windows == 0) return std::nullopt;
    return sum / static_cast<double>(windows);
  }

  ClockFit best_of(std::size_t half) const {
    ClockFit best;
    const auto search = [&](double around_s, double reach_s, double step_s) {
      for (double off_s = around_s - reach_s; off_s <= around_s + reach_s + 1e-9; off_s += step_s) {
        if (std::abs(off_s) < 0.5 * step_s) continue;  // the given one
        const auto found = gain_of(half, off_s);
        if (found && *found > best.gain) best = {off_s, *found};
      }
    };
    search(0.0, kFarthest_s, 0.05);
    search(best.off_s, 0.04, 0.01);
    return best;
  }

  const Sequence& sequence_;
  const PoseAt& pose_at_;
  std::vector<Window> windows_;
};

/// How far poses begin and end after scans do, where that is the same: these are of one drive.
std::optional<std::int64_t> offset_of_ends_ns(const std::vector<std::int64_t>& poses_ns,
                                              const std::vector<std::int64_t>& scans_ns) {
  if (poses_ns.size() < scans_ns.size()) return std::nullopt;
  const std::int64_t step_ns =
      (poses_ns.back() - poses_ns.front()) / static_cast<std::int64_t>(poses_ns.size());
  const std::int64_t first_ns = poses_ns.front() - scans_ns.front(),
                     last_ns = poses_ns.back() - scans_ns.back();
  if (std::abs(first_ns - last_ns) > step_ns || std::abs(first_ns + last_ns) <= 2 * step_ns) {
    return std::nullopt;
  }
  return (first_ns + last_ns) / 2;
}

}  // namespace

std::optional<std::int64_t> constant_offset_ns(const std::vector<std::int64_t>& poses_ns,
                                               const std::vector<std::int64_t>& scans_ns) {
  constexpr std::size_t kFewest = 5;
  constexpr std::int64_t kLeast_ns = 5'000'000, kSpread_ns = 2'000'000;
  if (scans_ns.size() < kFewest) return std::nullopt;
  if (poses_ns.size() != scans_ns.size()) return offset_of_ends_ns(poses_ns, scans_ns);
  std::vector<std::int64_t> offsets_ns;
  for (std::size_t k = 0; k < scans_ns.size(); ++k) {
    offsets_ns.push_back(poses_ns[k] - scans_ns[k]);
  }
  std::ranges::sort(offsets_ns);
  const std::int64_t middle_ns = offsets_ns[offsets_ns.size() / 2];
  const std::size_t tenth = offsets_ns.size() / 10;
  const std::int64_t spread_ns = offsets_ns[offsets_ns.size() - 1 - tenth] - offsets_ns[tenth];
  if (std::abs(middle_ns) < kLeast_ns || spread_ns > kSpread_ns) return std::nullopt;
  return middle_ns;
}

std::string to_string(const ClockDoubt& doubt) {
  if (!doubt.offset_s) return doubt.what;
  return fmt::format("{}; {} reads poses by the clock of the scans", doubt.what,
                     option("pose_offset_s", fmt::format("{}", *doubt.offset_s)));
}

void add_clock_doubt(Recording& recording, ClockDoubt doubt) {
  constexpr double kSame_s = 0.1;
  std::optional<double>& fitting_s = recording.reading.poses.fitting_offset_s;
  const bool is_same =
      fitting_s && doubt.offset_s && std::abs(*fitting_s - *doubt.offset_s) < kSame_s;
  if (is_same) doubt.offset_s = fitting_s;  // stamps tell it more exactly than surfaces
  if (doubt.offset_s) fitting_s = doubt.offset_s;
  recording.doubts.push_back(to_string(doubt));
}

double mending_offset_s(double asked_s, double late_s) {
  return std::round((asked_s - late_s) * 1e3) / 1e3 + 0.0;  // without the sign of -0
}

std::optional<ClockDoubt> doubt_about_clock(const Sequence& sequence, const PoseAt& pose_at) {
  constexpr double kLeast_s = 0.015;
  if (!pose_at) return std::nullopt;
  const auto fit = ClockFitting(sequence, pose_at).run();
  if (!fit || std::abs(fit->off_s) < kLeast_s) return std::nullopt;
  const std::string what = fmt::format(
      "the poses of {:.0f} ms {} the stamps of the scans fit these best, points are {:.1f} times "
      "likelier there: scans and poses are stamped by clocks that differ, or the points were "
      "measured that much later and not undistorted",
      1e3 * std::abs(fit->off_s), fit->off_s > 0.0 ? "after" : "before", std::exp(fit->gain));
  const double asked_s = sequence.reading().poses.offset_s.value_or(0.0);
  return ClockDoubt{what, mending_offset_s(asked_s, fit->off_s)};
}

}  // namespace mosbench
