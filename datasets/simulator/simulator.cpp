#include "datasets/simulator/simulator.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "datasets/sequence/portable_math.hpp"
#include "datasets/simulator/trajectory.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::int64_t kFirstStamp_ns = 1'600'000'000'000'000'000;

SensorModel with_scene_keys(SensorModel sensor, const Scene& scene) {
  if (scene.columns) sensor.columns = static_cast<std::size_t>(*scene.columns);
  if (scene.range_noise_m) sensor.range_noise_m = *scene.range_noise_m;
  if (scene.dropout_probability) sensor.dropout_probability = *scene.dropout_probability;
  return sensor;
}

Pose sensor_pose(const Scene& scene, const SensorModel& sensor, double time_s) {
  Pose pose = ego_pose(scene, time_s);
  const Eigen::Vector3d mount_m = rotated(pose.linear(), sensor.mount_m);
  pose.translation() += mount_m;
  return pose;
}

float intensity_of(std::uint32_t owner) {
  return static_cast<float>(0.1 + 0.8 * uniform(scatter_bits(owner)));
}

/// Lets a beam with another thing at its rim, not far before or behind, return a range between.
void mix(const SceneCast& cast, const Eigen::Vector3d& direction, double width_rad,
         std::uint64_t ray_word, RayHit& hit) {
  constexpr double kFarthestApart_m = 1.5;
  const auto draw = [&](std::uint64_t i) { return uniform(random_word(ray_word, ~i)); };
  const SinCos turn = sin_cos(6.283185307179586 * draw(0));
  const double level = std::sqrt(direction.x() * direction.x() + direction.y() * direction.y());
  if (level == 0.0) return;
  const Eigen::Vector3d aside(-direction.y() / level, direction.x() / level, 0.0);
  const Eigen::Vector3d up(-direction.z() * direction.x() / level,
                           -direction.z() * direction.y() / level, level);
  const double half_rad = width_rad / 2.0;
  const double scale = 1.0 / std::sqrt(1.0 + half_rad * half_rad);
  const Eigen::Vector3d rim = scale * (direction + half_rad * (turn.cos * aside + turn.sin * up));
  const auto other = cast.first_hit(rim, ray_word);
  if (!other || other->owner == hit.owner) return;
  const double apart_m = other->range_m - hit.range_m;
  if (std::abs(apart_m) <= kFarthestApart_m) hit.range_m += draw(1) * apart_m;
}

}  // namespace

Simulator::Simulator(Scene scene, const SensorModel& sensor, std::uint64_t seed)
    : scene_(std::move(scene)), sensor_(with_scene_keys(sensor, scene_)), seed_(seed) {
  if (repeats_every_scan(sensor_)) directions_ = beam_directions(sensor_, 0);
}

double Simulator::time_s(std::size_t scan_index) const {
  return static_cast<double>(scan_index) * scene_.scan_period_s;
}

Pose Simulator::map_from_sensor(std::size_t scan_index, double later_s) const {
  return sensor_pose(scene_, sensor_, time_s(scan_index) + later_s);
}

std::int64_t Simulator::stamp_ns(std::size_t scan_index) const {
  return kFirstStamp_ns + std::llround(time_s(scan_index) * 1e9);
}

SceneSnapshot Simulator::scene_at(std::size_t scan_index, double later_s) const {
  return snapshot(scene_, time_s(scan_index) + later_s);
}

SimulatedScan Simulator::scan(std::size_t scan_index) const {
  SimulatedScan result;
  result.scene = scene_at(scan_index);
  result.map_from_sensor = map_from_sensor(scan_index);
  result.stamp_ns = stamp_ns(scan_index);
  result.points.assign(sensor_.slots(), Point{});
  result.owners.assign(sensor_.slots(), SimulatedScan::kNoReturn);

  const std::vector<Eigen::Vector3d> own_directions =
      directions_.empty() ? beam_directions(sensor_, scan_index) : std::vector<Eigen::Vector3d>{};
  const std::vector<Eigen::Vector3d>& directions =
      directions_.empty() ? own_directions : directions_;
  const Eigen::Matrix3d rotation = result.map_from_sensor.linear();
  const SceneCast cast(scene_.ground, 0, result.scene.solids, result.map_from_sensor.translation(),
                       sensor_.max_range_m, scene_.ground_bumps_m.value_or(0.0));
  const double beam_width_rad = scene_.beam_width_rad.value_or(0.0);
  const std::uint64_t scan_seed =
      random_word(random_word(seed_, scan_index), static_cast<std::uint64_t>(sensor_.kind));
  for (std::size_t slot = 0; slot < directions.size(); ++slot) {
    const std::uint64_t ray_word = random_word(scan_seed, slot);
    if (uniform(scatter_bits(ray_word)) < sensor_.dropout_probability) continue;
    const Eigen::Vector3d direction = rotated(rotation, directions[slot]);
    auto hit = cast.first_hit(direction, ray_word);
    if (!hit) continue;
    if (beam_width_rad > 0.0) mix(cast, direction, beam_width_rad, ray_word, *hit);
    const double range_m =
        hit->range_m + sensor_.range_noise_m * nearly_normal(scatter_bits(~ray_word));
    if (range_m < sensor_.min_range_m) continue;
    const Eigen::Vector3d point_m = range_m * directions[slot];
    result.points[slot] = {static_cast<float>(point_m.x()), static_cast<float>(point_m.y()),
                           static_cast<float>(point_m.z()), intensity_of(hit->owner)};
    result.owners[slot] = hit->owner;
  }
  return result;
}

Frame Simulator::frame(std::size_t scan_index) const {
  SimulatedScan simulated = scan(scan_index);
  Frame frame;
  frame.stem = fmt::format("{:06}", scan_index);
  frame.map_from_sensor = simulated.map_from_sensor;
  frame.stamp_ns = simulated.stamp_ns;
  frame.truth.emplace();
  frame.truth->reserve(simulated.points.size());
  for (std::size_t i = 0; i < simulated.points.size(); ++i) {
    const bool is_lost = simulated.owners[i] == SimulatedScan::kNoReturn;
    frame.truth->push_back(is_lost ? 0 : moving_label(simulated.at(i)));
  }
  frame.points = std::move(simulated.points);
  return frame;
}

Simulator built_in_simulator(std::string_view scene, std::string_view sensor, std::uint64_t seed) {
  const auto kind = sensor_kind_from_string(sensor);
  if (!kind) {
    throw UsageError("'" + std::string(sensor) + "' is no sensor, expected one such as '" +
                     std::string(nearest_name(sensor, sensor_names())) + "'");
  }
  return Simulator(built_in_scene(scene), sensor_model(*kind), seed);
}

}  // namespace mosbench
