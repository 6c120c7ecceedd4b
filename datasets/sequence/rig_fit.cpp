#include "datasets/sequence/rig_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/sequence/registration.hpp"
#include "datasets/sequence/stamps.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

constexpr double kRigDeg = 180.0 / std::numbers::pi;
/// Places along the way that are looked at, and those that must show the same.
constexpr std::size_t kPlaces = 4, kAgreeing = 2;
/// A match of a smaller share of upright points, or that goes elsewhere when matched back, tells
/// nothing.
constexpr double kLeastOverlap = 0.4, kSameM = 0.2, kThickM = 0.1;
/// Points agree so many times better than under the mount. A search also finds what looks alike:
/// rows of posts, both sides of a road.
constexpr double kBetter = 1.2, kBetterSearched = 1.5;
constexpr double kOffM = 0.2, kOffDeg = 2.0;
/// LiDARs that turn from other directions on are off by up to a third of the way within a scan, if
/// their points have no times.
constexpr double kShareOfStep = 0.35;

/// Where scan matching puts a LiDAR, in the axes of the first.
struct Elsewhere {
  Pose moved = Pose::Identity();  ///< from its mount
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();

  double moved_m() const { return moved.translation().norm(); }
  double turned_deg() const { return kRigDeg * Eigen::AngleAxisd(moved.linear()).angle(); }
  /// How much later than its stamps the LiDAR measured, if that is all; nothing if it is not.
  std::optional<double> late_s() const {
    constexpr double kSlowestM_s = 1.0, kMostDeg = 10.0, kBesideM = 0.2;
    if (velocity_m_s.norm() < kSlowestM_s || turned_deg() > kMostDeg) return std::nullopt;
    const double late_s = moved.translation().dot(velocity_m_s) / velocity_m_s.squaredNorm();
    const double beside_m = (moved.translation() - late_s * velocity_m_s).norm();
    return beside_m < kBesideM ? std::optional(late_s) : std::nullopt;
  }
  bool agrees_with(const Elsewhere& other) const {
    constexpr double kAlikeM = 0.3, kAlikeDeg = 3.0, kAlikeS = 0.08;
    const Pose between = moved.inverse() * other.moved;
    const auto late = late_s(), others = other.late_s();
    if (late && others && std::abs(*late - *others) < kAlikeS) return true;
    return (moved.translation() - other.moved.translation()).norm() < kAlikeM &&
           kRigDeg * Eigen::AngleAxisd(between.linear()).angle() < kAlikeDeg;
  }
};

/// Returns the points of one LiDAR as seen from it, in the axes of the first.
RegisteredScan scan_of(const Frame& frame, std::size_t lidar) {
  constexpr double kSurfaceM = 1.0;
  std::vector<Point> points;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (frame.origins.of_point[i] != lidar || !is_return(frame.points[i])) continue;
    const Eigen::Vector3f p = (position_of(frame.points[i]) - frame.origins.at(i)).cast<float>();
    points.push_back({p.x(), p.y(), p.z(), 0.0F});
  }
  return {points, kSurfaceM};
}

double height_m(const RegisteredScan& scan) {
  std::vector<double> heights_m;
  for (const Eigen::Vector3d& point_m : scan.ground_m) heights_m.push_back(point_m.z());
  return median(std::move(heights_m));
}

/// Returns the share of upright points on surfaces and that of points of the ground, added.
double agreement(const RegisteredScan& wide, const RegisteredScan& narrow, const Pose& motion) {
  double sum = 0.0;
  for (const Eigen::Vector3d& point_m : narrow.ground_m) {
    const Eigen::Vector3d moved_m = motion * point_m;
    const auto* surface = wide.surface_at(moved_m);
    if (surface == nullptr) continue;
    const Eigen::Vector3d off_m = moved_m - surface->mean_m;
    sum += std::exp(-0.5 * off_m.dot(surface->information(kThickM) * off_m));
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, narrow.ground_m.size()));
  return upright_overlap(wide, narrow, motion, 1, kThickM) + sum / count;
}

struct Match {
  Pose motion = Pose::Identity();
  double overlap = 0.0;
  bool tells = false;
};

Match matched(const RegisteredScan& wide, const RegisteredScan& narrow, const Pose& start) {
  const Pose motion = registered(wide, narrow, start).motion;
  const Pose back = registered(narrow, wide, motion.inverse()).motion;
  const double overlap = upright_overlap(wide, narrow, motion, 1, kThickM);
  const bool tells = overlap > kLeastOverlap && difference_m(motion, back.inverse()) < kSameM;
  return {motion, overlap, tells};
}

/// Returns the best match around the mount, and around others that are turned upright.
Match searched(const RegisteredScan& wide, const RegisteredScan& narrow, const Pose& mount) {
  constexpr int kTurns = 24;
  const double lift_m = height_m(wide) - height_m(narrow);
  Match best;
  for (int turn = -1; turn < kTurns; ++turn) {
    Pose start = mount;
    if (turn >= 0) {
      const double yaw_rad = 2.0 * std::numbers::pi * turn / kTurns;
      start = Pose(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
      start.translation().z() = lift_m;
    }
    const Match found = matched(wide, narrow, searched_start(wide, narrow, start));
    if (found.overlap > best.overlap) best = found;
  }
  return best;
}

/// Returns where the LiDAR is, if not at its mount; nothing where scan matching does not tell.
std::optional<Elsewhere> elsewhere(const RegisteredScan& first, const RegisteredScan& other,
                                   const Pose& first_from_other) {
  // The view of one may be a part of that of the other.
  const bool is_wider = other.surfaces.size() > first.surfaces.size();
  const RegisteredScan &wide = is_wider ? other : first, &narrow = is_wider ? first : other;
  const Pose mount = is_wider ? first_from_other.inverse() : first_from_other;
  Match match = matched(wide, narrow, mount);
  const bool is_near = match.tells;
  if (!is_near) match = searched(wide, narrow, mount);
  const double least = is_near ? kBetter : kBetterSearched;
  const bool is_better =
      agreement(wide, narrow, match.motion) > least * agreement(wide, narrow, mount);
  if (!match.tells || !is_better) return std::nullopt;
  Elsewhere there{is_wider ? match.motion.inverse() : match.motion};
  there.moved.translation() -= first_from_other.translation();
  return there;
}

/// Returns scans that are evenly spread over the way, so that the vehicle moves if it ever does.
std::vector<std::size_t> places_along(const Sequence& rig) {
  constexpr double kStandingM = 0.01;
  std::vector<double> way_m = {0.0};
  for (std::size_t k = 1; k < rig.size(); ++k) {
    const Pose step = rig.map_from_sensor(k - 1).inverse() * rig.map_from_sensor(k);
    way_m.push_back(way_m.back() + kStandingM + step.translation().norm());
  }
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double at_m = way_m.back() * static_cast<double>(2 * i + 1) / (2 * kPlaces);
    const auto place =
        static_cast<std::size_t>(std::ranges::lower_bound(way_m, at_m) - way_m.begin());
    if (places.empty() || places.back() != place) places.push_back(place);
  }
  return places;
}

/// From the scan before to the scan after.
Eigen::Vector3d velocity_m_s(const Sequence& rig, std::size_t scan) {
  const std::size_t from = scan == 0 ? 0 : scan - 1, to = std::min(scan + 1, rig.size() - 1);
  const double step_s = 1e-9 * static_cast<double>(*rig.stamp_ns(to) - *rig.stamp_ns(from));
  const Pose step = rig.map_from_sensor(from).inverse() * rig.map_from_sensor(to);
  return step_s > 0.0 ? Eigen::Vector3d(step.translation() / step_s) : Eigen::Vector3d::Zero();
}

std::string sentence(const std::string& name, const std::string& first, const Elsewhere& there) {
  const auto late_s = there.late_s();
  return fmt::format(
      "{} does not fit {}: scan matching puts it {:.2f} m and {:.1f} degrees from its mount, "
      "expected vehicle_from_lidar in metres{}",
      name, first, there.moved_m(), there.turned_deg(),
      late_s ? fmt::format(", or its stamps {:.2f} s {}", std::abs(*late_s),
                           *late_s > 0.0 ? "later" : "earlier")
             : "");
}

}  // namespace

std::vector<std::string> doubts_about_mounts(const Sequence& rig) {
  const std::vector<std::string>& names = rig.recording().lidars;
  if (names.empty()) return {};
  const double step_s = usual_step_s(rig.recording().scans).value_or(0.1);
  std::vector<std::vector<Elsewhere>> found(names.size());
  for (const std::size_t scan : places_along(rig)) {
    const Frame frame = rig.read(scan);
    const RegisteredScan first = scan_of(frame, 0);
    const Eigen::Vector3d velocity = velocity_m_s(rig, scan);
    const double limit_m = std::max(kOffM, kShareOfStep * step_s * velocity.norm());
    for (std::size_t lidar = 1; lidar < names.size(); ++lidar) {
      Pose mount = Pose::Identity();
      mount.translation() = frame.origins.positions_m[lidar];
      auto there = elsewhere(first, scan_of(frame, lidar), mount);
      if (!there || (there->moved_m() < limit_m && there->turned_deg() < kOffDeg)) continue;
      there->velocity_m_s = velocity;
      found[lidar].push_back(*there);
    }
  }
  std::vector<std::string> doubts;
  for (std::size_t lidar = 1; lidar < names.size(); ++lidar) {
    for (const Elsewhere& there : found[lidar]) {
      const auto agreeing = std::ranges::count_if(
          found[lidar], [&](const Elsewhere& other) { return there.agrees_with(other); });
      if (static_cast<std::size_t>(agreeing) < kAgreeing) continue;
      doubts.push_back(sentence(names[lidar], names.front(), there));
      break;
    }
  }
  return doubts;
}

void doubt_mounts(Sequence& rig) {
  try {
    for (std::string& doubt : doubts_about_mounts(rig)) rig.add_doubt(std::move(doubt));
  } catch (const DataError&) {
  }
}

}  // namespace mosbench
