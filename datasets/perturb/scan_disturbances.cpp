#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/perturb/perturbation.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

Eigen::Vector3d normal_vector(const Draws& draws) {
  return {draws.normal(0), draws.normal(1), draws.normal(2)};
}

Pose motion(const Eigen::Vector3d& translation_m, const Eigen::Vector3d& rotation_rad) {
  Pose pose = Pose::Identity();
  pose.linear() = rotation_of(rotation_rad);
  pose.translation() = translation_m;
  return pose;
}

double length_of(const Eigen::Vector3d& v) {
  return std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
}

/// How far a pose may move and turn: one of both, as the unit of the disturbance says.
struct Strength {
  double m, rad;
};

Strength strength_of(const PerturbContext& context) {
  const bool is_angle = context.kind.unit.starts_with("deg");
  return is_angle ? Strength{0, context.strength * kRadPerDeg} : Strength{context.strength, 0};
}

/// Moves all poses from the jump on by a motion of the map.
void jump(const PerturbContext& context, const Pose& by, ScanList& list) {
  const std::size_t count = context.original.scans.size();
  const std::size_t at = context.shared.jump_scan.value_or(count / 2);
  if (at >= count) {
    throw UsageError(fmt::format("{}: pose_jump_scan={} is no scan of {}, expected 0 to {}",
                                 option("perturb"), at, context.original.name.text(), count - 1));
  }
  const auto first = std::ranges::lower_bound(list.sources, at);
  if (first == list.sources.end()) return;
  const auto begin = static_cast<std::size_t>(first - list.sources.begin());
  const Eigen::Vector3d center = list.scans[begin].map_from_sensor.translation();
  Pose around = by;
  around.translation() += center - rotated(by.linear(), center);
  for (std::size_t k = begin; k < list.scans.size(); ++k) {
    list.scans[k].map_from_sensor = compose(around, list.scans[k].map_from_sensor);
  }
}

template <typename Keep>
void keep_scans(ScanList& list, Keep&& keep) {
  ScanList kept;
  for (std::size_t k = 0; k < list.scans.size(); ++k) {
    if (!keep(k)) continue;
    kept.scans.push_back(std::move(list.scans[k]));
    kept.sources.push_back(list.sources[k]);
  }
  list = std::move(kept);
}

std::int64_t stamp_of(const ScanEntry& scan, const Recording& recording) {
  if (scan.stamp_ns) return *scan.stamp_ns;
  throw UsageError(
      fmt::format("{}: stamp_jitter_s: the scans of {} have no stamps, expected "
                  "a sequence with times",
                  option("perturb"), recording.name.text()));
}

}  // namespace

/// Noise is added in the sensor's frame: map_from_sensor * noise.
void add_pose_noise(const PerturbContext& context, ScanList& list) {
  const auto [m, rad] = strength_of(context);
  for (std::size_t k = 0; k < list.scans.size(); ++k) {
    const Eigen::Vector3d noise = normal_vector(context.draws.of(list.sources[k]));
    Pose& pose = list.scans[k].map_from_sensor;
    pose = compose(pose, motion(noise * m, noise * rad));
  }
}

/// The motion between scans gets noise that grows with the root of how far it went, or turned; the
/// first pose stays.
void add_pose_drift(const PerturbContext& context, ScanList& list) {
  const auto [m, rad] = strength_of(context);
  const std::vector<ScanEntry> before = list.scans;
  for (std::size_t k = 1; k < list.scans.size(); ++k) {
    const Pose step = compose(inverse_of(before[k - 1].map_from_sensor), before[k].map_from_sensor);
    const double walked = std::sqrt(length_of(step.translation()));
    const double turned = std::sqrt(length_of(rotation_vector(step.linear())) / kRadPerDeg);
    const Eigen::Vector3d noise = normal_vector(context.draws.of(list.sources[k]));
    list.scans[k].map_from_sensor = compose(compose(list.scans[k - 1].map_from_sensor, step),
                                            motion(noise * (m * walked), noise * (rad * turned)));
  }
}

void add_pose_jump(const PerturbContext& context, ScanList& list) {
  const auto [m, rad] = strength_of(context);
  const SinCos heading = sin_cos(kFullTurn_rad * context.draws.uniform(0));
  jump(context, motion({m * heading.cos, m * heading.sin, 0}, {0, 0, rad}), list);
}

void keep_every_nth_scan(const PerturbContext& context, ScanList& list) {
  const auto step = static_cast<std::size_t>(context.strength);
  keep_scans(list, [&](std::size_t k) { return k % step == 0; });
}

void lose_scans(const PerturbContext& context, ScanList& list) {
  keep_scans(list, [&](std::size_t k) {
    return k == 0 || context.draws.uniform(list.sources[k]) >= context.strength;
  });
}

void jitter_stamps(const PerturbContext& context, ScanList& list) {
  constexpr double kMostOfGap = 0.49;
  std::vector<std::int64_t> stamps_ns;
  for (const ScanEntry& scan : list.scans) stamps_ns.push_back(stamp_of(scan, context.original));
  for (std::size_t k = 0; k < stamps_ns.size(); ++k) {
    double most_ns = INFINITY;
    const auto stay_off = [&](std::int64_t gap_ns) {
      most_ns =
          std::min(most_ns, kMostOfGap * static_cast<double>(std::max<std::int64_t>(0, gap_ns)));
    };
    if (k > 0) stay_off(stamps_ns[k] - stamps_ns[k - 1]);
    if (k + 1 < stamps_ns.size()) stay_off(stamps_ns[k + 1] - stamps_ns[k]);
    const double noise_ns = 1e9 * context.strength * context.draws.normal(list.sources[k]);
    list.scans[k].stamp_ns =
        stamps_ns[k] + static_cast<std::int64_t>(std::clamp(noise_ns, -most_ns, most_ns));
  }
}

}  // namespace mosbench
