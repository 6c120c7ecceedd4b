#include "core/odometry/scan_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "core/odometry/rigid_motion.hpp"
#include "core/odometry/scan_points.hpp"

namespace mosbench::odometry {
namespace {

constexpr double kGapPeriods = 2.5;

// Predictions beyond this come of a lost pose and would only lead farther away.
constexpr double kMostMotion_m = 100.0;
constexpr double kMostMissedPeriods = 20.0;

void add_doubt(ScanPose& pose, const std::string& doubt) {
  if (doubt.empty()) return;
  if (pose.doubtful()) pose.doubt += "; ";
  pose.doubt += doubt;
}

template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  stream.precision(3);
  (stream << ... << parts);
  return stream.str();
}

std::string weak_motion(const Certainty& certainty) {
  const Eigen::Vector3d turn = certainty.weakest_direction.head<3>();
  const Eigen::Vector3d shift = certainty.weakest_direction.tail<3>();
  const bool turns = turn.norm() > shift.norm();
  const Eigen::Vector3d axis = (turns ? turn : shift).normalized();
  return text("its surfaces hardly constrain ", turns ? "turns about" : "motion along", " (",
              std::round(axis.x() * 100) / 100, ", ", std::round(axis.y() * 100) / 100, ", ",
              std::round(axis.z() * 100) / 100, ") of the sensor's frame");
}

}  // namespace

ScanClock::ScanClock(double default_period_s)
    : period_ns_(static_cast<std::int64_t>(default_period_s * 1e9)) {}

ScanClock::Interval ScanClock::tick(std::optional<std::int64_t> stamp_ns) {
  if (!stamp_ns || !last_ns_) {
    last_ns_ = stamp_ns;
    return {.period_ns = period_ns_, .doubt = {}};
  }
  // As double: the difference of two arbitrary stamps may not fit.
  const double passed_ns = static_cast<double>(*stamp_ns) - static_cast<double>(*last_ns_);
  if (!(passed_ns > 0)) {
    return {.period_ns = period_ns_, .doubt = "its stamp is not after that of the scan before"};
  }
  last_ns_ = stamp_ns;
  const double periods = passed_ns / static_cast<double>(period_ns_);
  if (measured_ && periods > kGapPeriods) {
    std::ostringstream doubt;
    doubt.precision(3);
    doubt << "it comes " << passed_ns * 1e-9 << " s after the scan before";
    return {.period_ns = period_ns_, .periods = periods, .doubt = doubt.str()};
  }
  // A first interval of any length is what is usual, if it can be.
  if (passed_ns < 1e12 && passed_ns >= 1e5) {
    period_ns_ = static_cast<std::int64_t>(passed_ns);
    measured_ = true;
  }
  return {.period_ns = period_ns_, .doubt = {}};
}

Pose ScanOdometry::predict(double periods) const {
  const Pose motion = previous_.inverse() * last_;
  if (!(motion.translation().norm() * periods <= kMostMotion_m)) return last_;
  if (periods == 1) return predicted(previous_, last_);
  return rigid(last_ * part_of(motion, std::min(periods, kMostMissedPeriods)));
}

void ScanOdometry::take(const ScanPoints& scan, const ScanTimes& times, const Pose& motion,
                        std::int64_t period_ns) {
  const bool straight = config_.deskew == Deskew::kNone || times.point_times_ns.empty();
  last_scan_ = {straight ? scan.points_m : deskewed(scan, times.point_times_ns, motion, period_ns),
                scan.rows};
  engine_->take(last_scan_.points_m);
}

void ScanOdometry::enter_last() {
  if (enters_) engine_->enter(last_);
  enters_ = false;
}

void ScanOdometry::leave_out(std::span<const std::uint8_t> moving) {
  if (moving.size() != last_points_) {
    throw std::invalid_argument(text("moving: ", moving.size(), " numbers for ", last_points_,
                                     " points, expected one per point"));
  }
  if (std::ranges::none_of(moving, [](std::uint8_t moves) { return moves != 0; })) return;
  last_scan_ = without(last_scan_, moving);
  engine_->take(last_scan_.points_m);
  if (!first_scan_.points_m.empty()) first_scan_ = without(first_scan_, moving);
}

Alignment ScanOdometry::align(const ScanPoints& scan, const ScanTimes& times, const Pose& seed,
                              std::int64_t period_ns) {
  const bool timed = config_.deskew != Deskew::kNone && !times.point_times_ns.empty();
  if (timed && poses_ == 1 && !first_times_ns_.empty()) {
    return align_with_first(scan, times, seed, period_ns);
  }
  const Alignment first = engine_->align(seed);
  if (config_.deskew != Deskew::kPoses || times.point_times_ns.empty()) return first;
  take(scan, times, last_.inverse() * first.map_from_sensor, period_ns);
  return engine_->align(first.map_from_sensor);
}

Alignment ScanOdometry::align_with_first(const ScanPoints& scan, const ScanTimes& times,
                                         const Pose& seed, std::int64_t period_ns) {
  // Two scans that are skewed alike are registered as well as straight ones. With the motion
  // between them both are corrected: points of a skewed first scan in the map would shift all later
  // scans.
  const Pose found = engine_->align(seed).map_from_sensor;
  const Pose motion = last_.inverse() * found;
  engine_->forget();
  take(first_scan_, {std::nullopt, first_times_ns_}, motion, period_ns);
  engine_->enter(last_);
  take(scan, times, motion, period_ns);
  return engine_->align(found);
}

Certainty ScanOdometry::certainty_at(const Pose& map_from_sensor) const {
  const auto samples = surface_samples(engine_->surfaces(), engine_->spacing_m());
  std::vector<std::optional<Eigen::Vector3d>> offsets_m;
  offsets_m.reserve(samples.size());
  for (const SurfaceSample& sample : samples) {
    const Eigen::Vector3d q = moved(map_from_sensor, sample.point_m);
    auto& offset_m = offsets_m.emplace_back(engine_->nearest(q));
    if (offset_m) offset_m = map_from_sensor.linear().transpose() * (q - *offset_m);
  }
  return certainty_of(samples, offsets_m);
}

void ScanOdometry::doubt_unless_it_comes_back(const Eigen::Vector3d& weakest_shift,
                                              ScanPose& pose) const {
  Pose beside = pose.map_from_sensor;
  const double shift_m = engine_->probe_m();
  beside.translation() += beside.linear() * (shift_m * weakest_shift);
  const auto off_m = [&](const Pose& settled) -> Eigen::Vector3d {
    return settled.translation() - pose.map_from_sensor.translation();
  };
  if (off_m(engine_->settled_from(beside)).norm() < shift_m / 2) return;
  // Some of the points may be too few.
  const Eigen::Vector3d all_off_m = off_m(engine_->align(beside).map_from_sensor);
  if (all_off_m.norm() < shift_m / 2) return;
  add_doubt(pose, text("registration from ", shift_m, " m beside it settles ", all_off_m.norm(),
                       " m off it"));
  pose.covariance.bottomRightCorner<3, 3>() += all_off_m * all_off_m.transpose();
}

ScanPose ScanOdometry::judged(const Alignment& alignment, const Pose& seed,
                              double plausible_m) const {
  ScanPose pose{.map_from_sensor = alignment.map_from_sensor, .doubt = {}};
  const Certainty certainty = certainty_at(pose.map_from_sensor);
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.map_from_sensor.linear();
  pose.covariance = turn * certainty.covariance * turn.transpose();
  pose.geometry = certainty.weakest;
  pose.condition = certainty.condition;
  pose.overlap = alignment.overlap;
  if (!alignment.settled) add_doubt(pose, "registration did not settle");
  if (pose.overlap < config_.min_overlap) {
    add_doubt(pose, text("only ", std::round(pose.overlap * 100), " % of it overlap the map"));
  }
  if (pose.geometry < config_.min_geometry) add_doubt(pose, weak_motion(certainty));
  doubt_unless_it_comes_back(certainty.weakest_shift, pose);
  const double surprise_m = (seed.inverse() * pose.map_from_sensor).translation().norm();
  if (surprise_m > plausible_m) {
    add_doubt(pose, text("it lies ", surprise_m, " m off constant velocity"));
  }
  return pose;
}

void ScanOdometry::keep_first(const ScanPoints& scan, const ScanTimes& times) {
  first_scan_ = scan;
  first_times_ns_.clear();
  if (scan.points_m.empty()) return;
  first_times_ns_.assign(times.point_times_ns.begin(), times.point_times_ns.end());
}

double ScanOdometry::plausible_jump_m(const ScanClock::Interval& interval) const {
  // Nothing is known of the velocity before the second scan.
  if (poses_ < 2) return std::numeric_limits<double>::infinity();
  const double passed_s = static_cast<double>(interval.period_ns) * 1e-9 * interval.periods;
  return config_.max_jump_m + config_.max_acceleration_m_s2 * passed_s * passed_s;
}

ScanPose ScanOdometry::push(std::span<const Point> points, const ScanTimes& times) {
  if (!times.point_times_ns.empty() && times.point_times_ns.size() != points.size()) {
    throw std::invalid_argument(text("point_times_ns: ", times.point_times_ns.size(), " times of ",
                                     points.size(), " points, expected one per point"));
  }
  enter_last();
  last_points_ = points.size();
  const ScanClock::Interval interval = clock_.tick(times.stamp_ns);
  const bool first = poses_ == 0;
  const Pose seed = first ? Pose::Identity() : predict(interval.periods);
  const ScanPoints scan = points_in_range(points, config_);
  take(scan, times, previous_.inverse() * last_, interval.period_ns);

  ScanPose pose{.map_from_sensor = seed, .doubt = {}};
  const bool enough = engine_->taken().size() >= static_cast<std::size_t>(config_.min_points);
  if (enough && engine_->map_points() > 0) {
    const Alignment alignment = align(scan, times, seed, interval.period_ns);
    engine_->learn(alignment.map_from_sensor.inverse() * seed);
    pose = judged(alignment, seed, plausible_jump_m(interval));
  } else if (enough && !first) {
    add_doubt(pose, "no scan before it could be used");
  } else if (!enough) {
    add_doubt(pose, text("only ", engine_->taken().size(), " points between min_range_m and ",
                         "max_range_m after thinning"));
  }
  pose.registered_points = engine_->taken().size();
  add_doubt(pose, interval.doubt);
  enters_ = enough;
  keep_first(first && enough ? scan : ScanPoints{}, times);
  previous_ = first ? pose.map_from_sensor : last_;
  last_ = pose.map_from_sensor;
  poses_ = std::min(poses_ + 1, 2);
  return pose;
}

}  // namespace mosbench::odometry
