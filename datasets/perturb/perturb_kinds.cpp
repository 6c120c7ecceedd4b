#include "datasets/perturb/perturb_kinds.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "datasets/formats/point_range.hpp"

namespace mosbench {

std::span<const PerturbKind> perturb_kinds() {
  static constexpr std::array kKinds = {
      PerturbKind{
          .name = "pose_noise_m",
          .unit = "m",
          .definition = "standard deviation of white noise of each pose's position, per axis",
          .source = "Thrun, Burgard, Fox, Probabilistic Robotics (2005), 5.2",
          .change_scans = add_pose_noise},
      PerturbKind{
          .name = "pose_noise_deg",
          .highest = 30,
          .unit = "deg",
          .definition =
              "standard deviation of white noise of each pose's rotation, per axis of the sensor",
          .source = "Thrun, Burgard, Fox, Probabilistic Robotics (2005), 5.2",
          .change_scans = add_pose_noise},
      PerturbKind{.name = "pose_drift_m",
                  .unit = "m after 1 m",
                  .definition = "random walk of the position: each motion of length d gets noise "
                                "of this times the root of d, per axis",
                  .source = "odometry model of Probabilistic Robotics (2005), 5.4; drift as in "
                            "Schmid et al., Dynablox (2023)",
                  .change_scans = add_pose_drift},
      PerturbKind{.name = "pose_drift_deg",
                  .highest = 30,
                  .unit = "deg after 1 deg",
                  .definition = "random walk of the rotation: each turn by a degrees gets noise of "
                                "this times the root of a, per axis",
                  .source = "odometry model of Probabilistic Robotics (2005), 5.4; drift as in "
                            "Schmid et al., Dynablox (2023)",
                  .change_scans = add_pose_drift},
      PerturbKind{.name = "pose_jump_m",
                  .unit = "m",
                  .definition =
                      "all poses from pose_jump_scan on move by this, level, in a random direction",
                  .source = "what closing a loop does to a pose graph",
                  .change_scans = add_pose_jump},
      PerturbKind{
          .name = "pose_jump_deg",
          .lowest = -180,
          .highest = 180,
          .unit = "deg",
          .definition =
              "all poses from pose_jump_scan on turn by this about the vertical through its sensor",
          .source = "what closing a loop does to a pose graph",
          .is_random = false,
          .change_scans = add_pose_jump},
      PerturbKind{
          .name = "range_noise_m",
          .unit = "m",
          .definition =
              "standard deviation of normal noise of each range; no return comes nearer than 1 cm",
          .source = "Probabilistic Robotics (2005), 6.3",
          .point_change = range_noise},
      PerturbKind{.name = "range_bias_m",
                  .lowest = -1e6,
                  .unit = "m",
                  .definition = "is added to every range; no return comes nearer than 1 cm",
                  .source = "systematic part of a sensor's stated accuracy",
                  .is_random = false,
                  .point_change = range_bias},
      PerturbKind{.name = "dropout_probability",
                  .highest = 1,
                  .unit = "1",
                  .definition = "probability that a return is lost",
                  .source = "Bernoulli trials per return",
                  .changes_truth = true,
                  .point_change = dropout},
      PerturbKind{
          .name = "dropout_per_m",
          .unit = "1/m",
          .definition = "a return at range r is lost with probability 1 - exp(-r times this)",
          .source = "law of Beer and Lambert",
          .changes_truth = true,
          .point_change = dropout_by_range},
      PerturbKind{.name = "beams",
                  .none = std::numeric_limits<double>::quiet_NaN(),
                  .lowest = 1,
                  .highest = 4096,
                  .unit = "beams",
                  .definition = "only this many of the beams_of beams are left, evenly spaced",
                  .source = "Wei et al., LiDAR Distillation (2022), 3.2",
                  .is_random = false,
                  .changes_truth = true,
                  .point_change = fewer_beams},
      PerturbKind{.name = "every_nth_scan",
                  .none = 1,
                  .lowest = 1,
                  .unit = "scans",
                  .definition = "only every n-th scan is left, the first included",
                  .source = "a slower sensor",
                  .is_random = false,
                  .change_scans = keep_every_nth_scan},
      PerturbKind{.name = "scan_loss_probability",
                  .highest = 1,
                  .unit = "1",
                  .definition = "probability that a scan is lost; the first never is",
                  .source = "Bernoulli trials per scan",
                  .change_scans = lose_scans},
      PerturbKind{.name = "stamp_jitter_s",
                  .unit = "s",
                  .definition = "standard deviation of normal noise of each stamp, cut at 0.49 of "
                                "the time to the nearer neighbour, so that the order stays",
                  .source = "jitter of a clock",
                  .change_scans = jitter_stamps},
      PerturbKind{
          .name = "rain_mm_per_h",
          .highest = 300,
          .unit = "mm/h",
          .definition =
              "drops that return more light than the target take its place, weak targets are lost",
          .source = "Kilic et al., LISA (2021), of drops by Marshall and Palmer (1948)",
          .changes_truth = true,
          .point_change = rain},
      PerturbKind{.name = "fog_per_m",
                  .highest = 1,
                  .unit = "1/m",
                  .definition = "extinction: where fog returns more light than the target it takes "
                                "its place, weak targets are lost",
                  .source = "Hahner et al., Fog Simulation on Real LiDAR Point Clouds (2021); "
                            "Rasshofer et al. (2011)",
                  .changes_truth = true,
                  .point_change = fog},
      PerturbKind{.name = "mount_tilt_deg",
                  .lowest = -90,
                  .highest = 90,
                  .unit = "deg",
                  .definition = "the sensor looks down by this, and the poses do not know",
                  .source = "error of extrinsic calibration",
                  .is_random = false,
                  .point_change = mount_tilt},
      PerturbKind{
          .name = "time_warp",
          .highest = 1,
          .unit = "turns",
          .definition = "each return lies where the moving sensor saw it during a turn of this "
                        "length, behind first, the stamp ahead",
          .source = "Geiger et al., Vision meets Robotics (2013), 3; the inverse of undistortion",
          .needs_poses = true,
          .is_random = false,
          .point_change = time_warp},
  };
  return kKinds;
}

std::span<const PerturbKey> perturb_keys() {
  static constexpr std::array<std::string_view, 2> kJumps = {"pose_jump_m", "pose_jump_deg"};
  static constexpr std::array<std::string_view, 1> kBeams = {"beams"};
  static constexpr std::array<std::string_view, 2> kWeather = {"rain_mm_per_h", "fog_per_m"};
  static constexpr std::array kKeys = {
      PerturbKey{"seed", "of everything random (1)", {}},
      PerturbKey{"pose_jump_scan", "number of the scan, from 0 (the middle one)", kJumps},
      PerturbKey{"beams_of", "beams of the sensor (64)", kBeams},
      PerturbKey{"beams_top_deg",
                 "elevation of the highest beam; without it points lie beam by beam in each column",
                 kBeams},
      PerturbKey{"beams_bottom_deg", "elevation of the lowest beam", kBeams},
      PerturbKey{"sensor_range_m",
                 "farthest return of a weak target in clear air, for rain and fog (120)",
                 kWeather}};
  return kKeys;
}

bool is_return(const Point& point) {
  return is_finite(point) && (point.x != 0 || point.y != 0 || point.z != 0);
}

void lose_point(Frame& frame, std::size_t point) {
  frame.points[point] = {0, 0, 0, 0};
  if (frame.truth) (*frame.truth)[point] = 0;
  if (!frame.radial_velocity_m_s.empty()) frame.radial_velocity_m_s[point] = 0;
}

void set_range(Point& point, double range_m, double new_range_m) {
  const double scale = new_range_m / range_m;
  point.x = static_cast<float>(point.x * scale);
  point.y = static_cast<float>(point.y * scale);
  point.z = static_cast<float>(point.z * scale);
}

}  // namespace mosbench
