#include "datasets/perturb/perturbation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

[[noreturn]] void refuse(std::string_view what, const std::string& expected) {
  throw UsageError(fmt::format("{}: {}, expected {}", option("perturb"), what, expected));
}

[[noreturn]] void refuse_name(std::string_view name) {
  std::vector<std::string_view> names;
  for (const PerturbKind& kind : perturb_kinds()) names.push_back(kind.name);
  for (const PerturbKey& key : perturb_keys()) names.push_back(key.name);
  refuse(fmt::format("{} is not known", quoted(name)),
         fmt::format("one of {} (nearest: {})", fmt::join(names, ", "), nearest_name(name, names)));
}

std::uint64_t whole_number(std::string_view name, std::string_view text, std::uint64_t lowest,
                           std::uint64_t highest) {
  const auto number = parse_unsigned(text);
  if (number && *number >= lowest && *number <= highest) return *number;
  refuse(fmt::format("{}: {} is no number for it", name, quoted(text)),
         fmt::format("a whole number from {} to {}", lowest, highest));
}

double number_within(std::string_view name, std::string_view text, double lowest, double highest) {
  const auto number = parse_double(text);
  if (number && *number >= lowest && *number <= highest) return *number;
  refuse(fmt::format("{}: {} is no number for it", name, quoted(text)),
         fmt::format("a number from {:g} to {:g}", lowest, highest));
}

/// Returns whether the name is that of a shared key, which is then set.
bool set_key(std::string_view name, std::string_view text, Perturbation& perturbation) {
  constexpr std::uint64_t kMostScans = 1'000'000'000, kMostBeams = 4096;
  if (name == "seed") {
    perturbation.seed = whole_number(name, text, 0, UINT64_MAX);
  } else if (name == "pose_jump_scan") {
    perturbation.jump_scan = whole_number(name, text, 0, kMostScans);
  } else if (name == "beams_of") {
    perturbation.beams_of = whole_number(name, text, 2, kMostBeams);
  } else if (name == "beams_top_deg") {
    perturbation.beams_top_deg = number_within(name, text, -90, 90);
  } else if (name == "beams_bottom_deg") {
    perturbation.beams_bottom_deg = number_within(name, text, -90, 90);
  } else if (name == "sensor_range_m") {
    perturbation.sensor_range_m = number_within(name, text, 1, 10'000);
  } else {
    return false;
  }
  return true;
}

void add_step(std::string_view name, std::string_view text, Perturbation& perturbation) {
  const PerturbKind& kind = perturb_kind_named(name);
  const double strength = number_within(name, text, kind.lowest, kind.highest);
  const bool counts = kind.unit == "beams" || kind.unit == "scans";
  if (counts && strength != std::floor(strength)) {
    refuse(fmt::format("{}: {} is no count", name, quoted(text)), "a whole number");
  }
  perturbation.steps.push_back({kind.name, strength});
}

void check_beams(const Perturbation& perturbation) {
  if (perturbation.beams_top_deg.has_value() != perturbation.beams_bottom_deg.has_value()) {
    refuse("one of beams_top_deg and beams_bottom_deg is missing", "both of them, or neither");
  }
  if (perturbation.beams_top_deg &&
      !(*perturbation.beams_top_deg > *perturbation.beams_bottom_deg)) {
    refuse("beams_top_deg is not above beams_bottom_deg", "elevations from top to bottom");
  }
  for (const PerturbStep& step : perturbation.steps) {
    if (step.kind != "beams") continue;
    if (perturbation.beams_of % static_cast<std::size_t>(step.strength) == 0) continue;
    refuse(fmt::format("beams: {:g} of {} cannot be evenly spaced", step.strength,
                       perturbation.beams_of),
           "a divisor of beams_of");
  }
}

/// A key that nothing uses is one whose kind was forgotten.
void check_used(const Perturbation& perturbation, const std::vector<std::string_view>& said) {
  if (perturbation.steps.empty()) refuse("no disturbance is given", "KIND=STRENGTH,...,seed=N");
  for (const PerturbKey& key : perturb_keys()) {
    if (key.kinds.empty() || std::ranges::find(said, key.name) == said.end()) continue;
    const bool is_used = std::ranges::any_of(perturbation.steps, [&](const PerturbStep& step) {
      return std::ranges::find(key.kinds, step.kind) != key.kinds.end();
    });
    if (is_used) continue;
    refuse(fmt::format("{} is given, but nothing that uses it", key.name),
           fmt::format("it with {}", fmt::join(key.kinds, " or ")));
  }
}

/// Returns the same word for a name everywhere (FNV-1a).
std::uint64_t word_of(std::string_view name) {
  std::uint64_t word = 0xCBF29CE484222325u;
  for (const char c : name) word = (word ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
  return word;
}

/// Moves the returns of a rig by their origins, to or from their own sensors.
void shift_by_origins(double sign, Frame& frame) {
  if (frame.origins.empty()) return;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    Point& p = frame.points[i];
    if (!is_return(p)) continue;
    const Eigen::Vector3d at = position_of(p) + sign * frame.origins.at(i);
    p = {static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()),
         p.intensity};
  }
}

class PerturbedSequence : public SequenceAround {
 public:
  PerturbedSequence(std::unique_ptr<Sequence> inner, const Perturbation& perturbation)
      : SequenceAround(std::move(inner)) {
    ScanList list{recording().scans, std::vector<std::size_t>(size())};
    std::iota(list.sources.begin(), list.sources.end(), std::size_t{0});
    const Draws draws = Draws(perturbation.seed).of(word_of(name()));
    for (std::size_t i = 0; i < perturbation.steps.size(); ++i) {
      const PerturbStep& step = perturbation.steps[i];
      const PerturbKind& kind = perturb_kind_named(step.kind);
      if (step.strength == kind.none) continue;
      add(kind, {kind, step.strength, draws.of(i), perturbation, this->inner().recording()}, list);
    }
    sources_ = std::move(list.sources);
    mutable_recording().scans = std::move(list.scans);
    mutable_recording().reading.perturb = perturbation;
    mutable_recording().remarks.push_back("disturbed on purpose: " + to_string(perturbation));
  }

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    const std::size_t source = sources_.at(scan_index);
    inner().read(source, frame);
    // Ranges and directions are those from the sensor that measured a point.
    shift_by_origins(-1, frame);
    for (const ChangePoints& change : changes_) change(source, frame);
    shift_by_origins(1, frame);
    frame.map_from_sensor = map_from_sensor(scan_index);
    frame.stamp_ns = stamp_ns(scan_index);
  }

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    if (!changes_truth_ || !has_truth(scan_index)) {
      return inner().read_truth(sources_.at(scan_index));
    }
    return Sequence::read_truth(scan_index);
  }

 private:
  void add(const PerturbKind& kind, const PerturbContext& context, ScanList& list) {
    if (kind.change_scans != nullptr) kind.change_scans(context, list);
    if (kind.point_change != nullptr) changes_.push_back(kind.point_change(context));
    changes_truth_ = changes_truth_ || kind.changes_truth;
  }

  std::vector<std::size_t> sources_;
  std::vector<ChangePoints> changes_;
  bool changes_truth_ = false;
};

}  // namespace

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

void set_range(Point& point, double range_m, double new_range_m) {
  const double scale = new_range_m / range_m;
  point.x = static_cast<float>(point.x * scale);
  point.y = static_cast<float>(point.y * scale);
  point.z = static_cast<float>(point.z * scale);
}

const PerturbKind& perturb_kind_named(std::string_view name) {
  const auto kind = std::ranges::find(perturb_kinds(), name, &PerturbKind::name);
  if (kind == perturb_kinds().end()) refuse_name(name);
  return *kind;
}

Perturbation parse_perturbation(std::string_view text) {
  Perturbation perturbation;
  std::vector<std::string_view> said;
  for (const std::string_view part : split_at_commas(text)) {
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos) {
      refuse(fmt::format("{} has no value", quoted(part)), "KIND=STRENGTH,...,seed=N");
    }
    const std::string_view name = trim(part.substr(0, equals));
    const std::string_view value = trim(part.substr(equals + 1));
    if (!set_key(name, value, perturbation)) {
      add_step(name, value, perturbation);
    } else if (std::ranges::find(said, name) != said.end()) {
      refuse(fmt::format("{} is given twice", name), "it once");
    } else {
      said.push_back(name);
    }
  }
  check_beams(perturbation);
  check_used(perturbation, said);
  return perturbation;
}

bool changes_points_only(const Perturbation& perturbation) {
  return std::ranges::none_of(perturbation.steps, [](const PerturbStep& step) {
    const PerturbKind& kind = perturb_kind_named(step.kind);
    return kind.needs_poses || kind.change_scans != nullptr;
  });
}

std::unique_ptr<Sequence> perturbed(std::unique_ptr<Sequence> inner,
                                    const Perturbation& perturbation) {
  return std::make_unique<PerturbedSequence>(std::move(inner), perturbation);
}

}  // namespace mosbench
