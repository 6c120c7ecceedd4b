#include "datasets/simulator/scene_cast.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

constexpr int kSectors = 720;
constexpr double kFullTurn = 4.0;

/// Grows with the azimuth like the angle, from 0 at +x by 1 per quarter turn, without
/// trigonometry. Opposite directions differ by exactly 2.
double diamond_angle(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (sum == 0.0) return 0.0;
  if (y >= 0.0) return x >= 0.0 ? y / sum : 1.0 - x / sum;
  return x < 0.0 ? 2.0 - y / sum : 3.0 + x / sum;
}

/// Returns the first and last sector that a footprint covers; wraps when last >= kSectors or first
/// < 0.
struct SectorRange {
  int first, last;
};

SectorRange sectors_of(const Solid& solid, const Eigen::Vector3d& origin_m) {
  const double x = solid.center_m.x() - origin_m.x();
  const double y = solid.center_m.y() - origin_m.y();
  const double middle = diamond_angle(x, y);
  double lowest = 0.0, highest = 0.0;
  for (const double along : {-solid.half_size_m.x(), solid.half_size_m.x()}) {
    for (const double across : {-solid.half_size_m.y(), solid.half_size_m.y()}) {
      double offset = diamond_angle(x + along * solid.axis.x() - across * solid.axis.y(),
                                    y + along * solid.axis.y() + across * solid.axis.x()) -
                      middle;
      // A convex footprint without the origin spans less than half a turn.
      if (offset > kFullTurn / 2) offset -= kFullTurn;
      if (offset < -kFullTurn / 2) offset += kFullTurn;
      lowest = std::min(lowest, offset);
      highest = std::max(highest, offset);
    }
  }
  // One sector of margin on either side makes rounding harmless.
  constexpr double kPerUnit = kSectors / kFullTurn;
  return {static_cast<int>(std::floor((middle + lowest) * kPerUnit)) - 1,
          static_cast<int>(std::floor((middle + highest) * kPerUnit)) + 1};
}

struct Interval {
  double enter_m, leave_m;
};
constexpr Interval kMissed{1.0, 0.0};

/// Returns where a ray is between two parallel planes at +-half.
Interval between(double origin, double direction, double half) {
  if (direction == 0.0) return std::abs(origin) < half ? Interval{-1e300, 1e300} : kMissed;
  const double inverse = 1.0 / direction;
  const double a = (-half - origin) * inverse, b = (half - origin) * inverse;
  return {std::min(a, b), std::max(a, b)};
}

Interval both(const Interval& a, const Interval& b) {
  return {std::max(a.enter_m, b.enter_m), std::min(a.leave_m, b.leave_m)};
}

/// Returns the solutions of a t^2 + 2 b t + c < 0.
Interval inside_quadric(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (discriminant <= 0.0 || a == 0.0) {
    return a == 0.0 && c < 0.0 ? Interval{-1e300, 1e300} : kMissed;
  }
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

Interval inside(const Solid& solid, const Eigen::Vector3d& o, const Eigen::Vector3d& d) {
  const Eigen::Vector3d& half = solid.half_size_m;
  switch (solid.shape) {
    case Shape::kBox:
      return both(between(o.x(), d.x(), half.x()),
                  both(between(o.y(), d.y(), half.y()), between(o.z(), d.z(), half.z())));
    case Shape::kCylinder:
      return both(inside_quadric(d.x() * d.x() + d.y() * d.y(), o.x() * d.x() + o.y() * d.y(),
                                 o.x() * o.x() + o.y() * o.y() - half.x() * half.x()),
                  between(o.z(), d.z(), half.z()));
    case Shape::kSphere:
      return inside_quadric(d.x() * d.x() + d.y() * d.y() + d.z() * d.z(),
                            o.x() * d.x() + o.y() * d.y() + o.z() * d.z(),
                            o.x() * o.x() + o.y() * o.y() + o.z() * o.z() - half.x() * half.x());
  }
  return kMissed;
}

Eigen::Vector3d into_axes(const Eigen::Vector2d& axis, const Eigen::Vector3d& v) {
  return {v.x() * axis.x() + v.y() * axis.y(), v.y() * axis.x() - v.x() * axis.y(), v.z()};
}

double nearest_horizontally_m(const Solid& solid, const Eigen::Vector3d& origin_in_axes_m) {
  const double dx = std::max(0.0, std::abs(origin_in_axes_m.x()) - solid.half_size_m.x());
  const double dy = std::max(0.0, std::abs(origin_in_axes_m.y()) - solid.half_size_m.y());
  return std::sqrt(dx * dx + dy * dy);
}

/// Leaves stay in place from scan to scan: a cell of the body is occupied or not for ever. Half of
/// the rays pass the leaves of an occupied cell.
bool leaf_stops(const Solid& solid, const Eigen::Vector3d& in_body_m, std::uint64_t ray_word,
                std::uint64_t step) {
  constexpr double kCellsPerMetre = 5.0;
  std::uint64_t word = solid.owner;
  for (const double coordinate_m : {in_body_m.x(), in_body_m.y(), in_body_m.z()}) {
    word = scatter_bits(word ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(
                                   std::floor(coordinate_m * kCellsPerMetre))));
  }
  return uniform(word) < solid.density && (random_word(ray_word, step) & 1) == 0;
}

/// Returns how far the ground is above its plane, alike in squares of 0.5 m.
double bump_m(const Eigen::Vector3d& at_m, double bumps_m) {
  constexpr double kSquaresPerMetre = 2.0;
  std::uint64_t word = 0;
  for (const double coordinate_m : {at_m.x(), at_m.y()}) {
    word = scatter_bits(word ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(
                                   std::floor(coordinate_m * kSquaresPerMetre))));
  }
  return bumps_m * (2.0 * uniform(word) - 1.0);
}

/// Returns where a ray goes that a box mirrors at a point of one of its faces.
Eigen::Vector3d direction_reflected(const Solid& box, const Eigen::Vector3d& at_m,
                                    const Eigen::Vector3d& direction) {
  const Eigen::Vector3d in_box_m = into_axes(box.axis, at_m - box.center_m);
  int face = 0;
  const auto outward = [&](int axis) { return std::abs(in_box_m(axis)) - box.half_size_m(axis); };
  for (const int axis : {1, 2}) face = outward(axis) > outward(face) ? axis : face;
  Eigen::Vector3d d = into_axes(box.axis, direction);
  d(face) = -d(face);
  return {d.x() * box.axis.x() - d.y() * box.axis.y(), d.x() * box.axis.y() + d.y() * box.axis.x(),
          d.z()};
}

}  // namespace

SceneCast::SceneCast(std::span<const GroundPlane> ground, std::uint32_t ground_owner,
                     std::span<const Solid> solids, const Eigen::Vector3d& origin_m,
                     double max_range_m, double bumps_m)
    : ground_(ground),
      ground_owner_(ground_owner),
      origin_m_(origin_m),
      max_range_m_(max_range_m),
      bumps_m_(bumps_m) {
  sort_into_sectors(solids);
}

void SceneCast::sort_into_sectors(std::span<const Solid> solids) {
  for (const Solid& solid : solids) {
    const Eigen::Vector3d origin_m = into_axes(solid.axis, origin_m_ - solid.center_m);
    const double nearest_m = nearest_horizontally_m(solid, origin_m);
    if (nearest_m < max_range_m_) candidates_.push_back({&solid, origin_m, nearest_m});
  }
  std::stable_sort(candidates_.begin(), candidates_.end(),
                   [](const auto& a, const auto& b) { return a.nearest_m < b.nearest_m; });

  std::array<std::vector<std::uint32_t>, kSectors> members;
  for (std::uint32_t i = 0; i < candidates_.size(); ++i) {
    SectorRange range = sectors_of(*candidates_[i].solid, origin_m_);
    if (candidates_[i].nearest_m == 0.0 || range.last - range.first >= kSectors) {
      range = {0, kSectors - 1};
    }
    for (int sector = range.first; sector <= range.last; ++sector) {
      members[static_cast<std::size_t>((sector + kSectors) % kSectors)].push_back(i);
    }
  }
  sector_begins_.push_back(0);
  for (const auto& sector : members) {
    sector_members_.insert(sector_members_.end(), sector.begin(), sector.end());
    sector_begins_.push_back(static_cast<std::uint32_t>(sector_members_.size()));
  }
}

void SceneCast::enter(const Candidate& candidate, const Eigen::Vector3d& direction,
                      std::uint64_t ray_word, RayHit& best) const {
  const Solid& solid = *candidate.solid;
  const Eigen::Vector3d d = into_axes(solid.axis, direction);
  const Interval interval = inside(solid, candidate.origin_m, d);
  if (!(interval.enter_m < interval.leave_m) || interval.enter_m >= best.range_m) return;
  if (solid.let_through > 0.0 && uniform(random_word(~ray_word, solid.owner)) < solid.let_through) {
    return;
  }
  if (solid.density >= 1.0) {
    if (interval.enter_m > 0.0) {
      best = {interval.enter_m, solid.owner, solid.mirrors ? &solid : nullptr};
    }
    return;
  }
  const Eigen::Vector3d from_leaves_m =
      candidate.origin_m - Eigen::Vector3d(solid.leaves_at_m, 0.0, 0.0);
  constexpr double kStep_m = 0.2;
  const double start_m = std::max(0.0, interval.enter_m) + kStep_m * uniform(ray_word);
  const double end_m = std::min(interval.leave_m, best.range_m);
  std::uint64_t step = 1;
  for (double range_m = start_m; range_m < end_m; range_m += kStep_m, ++step) {
    if (leaf_stops(solid, from_leaves_m + range_m * d, ray_word, step)) {
      best = {range_m, solid.owner};
      return;
    }
  }
}

/// Whether a ray from `origin_m` reaches the ground before `best`, which is the ground then.
bool SceneCast::reach_ground(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                             RayHit& best) const {
  bool hit = false;
  for (const GroundPlane& plane : ground_) {
    const double descent =
        plane.slope_x * direction.x() + plane.slope_y * direction.y() - direction.z();
    const double height_m =
        origin_m.z() - plane.height_m - plane.slope_x * origin_m.x() - plane.slope_y * origin_m.y();
    if (descent <= 0.0 || height_m <= 0.0 || height_m >= best.range_m * descent) continue;
    best = {height_m / descent, ground_owner_};
    if (bumps_m_ > 0.0) {
      const double nearer_m =
          bump_m(origin_m + best.range_m * direction, bumps_m_) / std::max(descent, bumps_m_);
      best.range_m = std::max(0.0, best.range_m - nearer_m);
    }
    hit = true;
  }
  return hit;
}

/// Returns what a mirror shows, as far behind it as the ray goes on.
std::optional<RayHit> SceneCast::reflected(const RayHit& hit, const Eigen::Vector3d& direction,
                                           std::uint64_t ray_word) const {
  const Solid& mirror = *hit.mirror;
  const Eigen::Vector3d at_m = origin_m_ + hit.range_m * direction;
  const Eigen::Vector3d away = direction_reflected(mirror, at_m, direction);
  RayHit shown{max_range_m_ - hit.range_m, ground_owner_};
  bool found = reach_ground(at_m, away, shown);
  for (const Candidate& candidate : candidates_) {
    const Solid& solid = *candidate.solid;
    if (&solid == &mirror) continue;
    const double before_m = shown.range_m;
    enter({&solid, into_axes(solid.axis, at_m - solid.center_m), 0.0}, away, ray_word, shown);
    found = found || shown.range_m < before_m;
  }
  if (!found) return std::nullopt;
  return RayHit{hit.range_m + shown.range_m, hit.owner};
}

std::optional<RayHit> SceneCast::first_hit(const Eigen::Vector3d& direction,
                                           std::uint64_t ray_word) const {
  RayHit best{max_range_m_, ground_owner_};
  const bool hit = reach_ground(origin_m_, direction, best);
  const double horizontal =
      std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
  const double turn = diamond_angle(direction.x(), direction.y()) / kFullTurn;
  const auto sector =
      std::min<std::size_t>(static_cast<std::size_t>(turn * kSectors), kSectors - 1);
  const double before_m = best.range_m;
  for (std::uint32_t i = sector_begins_[sector]; i < sector_begins_[sector + 1]; ++i) {
    const Candidate& candidate = candidates_[sector_members_[i]];
    if (candidate.nearest_m >= best.range_m * horizontal) break;
    enter(candidate, direction, ray_word, best);
  }
  if (!hit && best.range_m == before_m) return std::nullopt;
  return best.mirror == nullptr ? best : reflected(best, direction, ray_word);
}

}  // namespace mosbench
