#include <algorithm>

#include "core/odometry/engine.hpp"
#include "core/odometry/point_grid.hpp"
#include "core/odometry/simple_cost.hpp"

namespace mosbench::odometry {
namespace {

// exp(-10^2 / 2) = 2e-22: farther neighbours change no digit of the cost.
constexpr double kReachSigmas = 10.0;
// Fewer may well settle elsewhere than all points do.
constexpr std::size_t kProbePoints = 1500;

/// SiMpLE: Simple Mapping and Localisation Estimation (IJRR 2024).
class Simple : public Engine {
 public:
  Simple(const SimpleConfig& config, ThreadPool& pool)
      : config_(config), pool_(pool), map_(config.map_radius_m) {}

  void take(std::span<const Eigen::Vector3d> points_m) override {
    taken_ = thinned(points_m, config_.scan_radius_m);
    some_ = every_nth(taken_, std::clamp<std::size_t>(taken_.size() / kProbePoints, 1, 4));
  }
  std::span<const Eigen::Vector3d> taken() const override { return taken_; }
  std::span<const Eigen::Vector3d> surfaces() const override { return taken_; }
  double spacing_m() const override { return config_.scan_radius_m; }

  Alignment align(const Pose& seed) const override {
    const Minimum minimum = minimum_from(seed, taken_);
    Alignment result{.map_from_sensor = pose_of(minimum.at), .settled = minimum.settled};
    const auto overlapping = std::ranges::count_if(taken_, [&](const Eigen::Vector3d& p) {
      return nearest(moved(result.map_from_sensor, p)).has_value();
    });
    result.overlap = static_cast<double>(overlapping) / static_cast<double>(taken_.size());
    return result;
  }
  Pose settled_from(const Pose& seed) const override {
    return pose_of(minimum_from(seed, some_).at);
  }
  double probe_m() const override { return std::min(config_.sigma_m, config_.map_radius_m / 4); }

  std::optional<Eigen::Vector3d> nearest(const Eigen::Vector3d& position_m) const override {
    const Neighbour neighbour = map_.nearest(position_m, config_.map_radius_m);
    if (!(neighbour.distance_m < config_.map_radius_m)) return std::nullopt;
    return neighbour.point_m;
  }

  void enter(const Pose& map_from_sensor) override {
    std::vector<Eigen::Vector3d> in_map;
    in_map.reserve(taken_.size());
    for (const Eigen::Vector3d& p : taken_) in_map.push_back(moved(map_from_sensor, p));
    insert_apart(in_map, config_.map_radius_m, map_);
    map_.keep_within(map_from_sensor.translation(), config_.scan.max_range_m);
  }

  void forget() override { map_.clear(); }

  std::size_t map_points() const override { return map_.size(); }
  std::size_t memory_bytes() const override {
    return map_.memory_bytes() + (taken_.capacity() + some_.capacity()) * sizeof(Eigen::Vector3d);
  }

 private:
  Minimum minimum_from(const Pose& seed, std::span<const Eigen::Vector3d> points_m) const {
    const SimpleProblem problem{
        .points_m = points_m,
        .map = map_,
        .sigma_m = config_.sigma_m,
        .reach_m = std::max(kReachSigmas * config_.sigma_m, config_.map_radius_m)};
    if (config_.gradient == Gradient::kNumeric) {
      NumericCost cost(problem, pool_);
      return minimise(cost, angles_of(seed), config_.tolerance);
    }
    AnalyticCost cost(problem, pool_);
    return minimise(cost, angles_of(seed), config_.tolerance);
  }

  SimpleConfig config_;
  ThreadPool& pool_;
  PointGrid map_;
  std::vector<Eigen::Vector3d> taken_, some_;
};

}  // namespace

std::unique_ptr<Engine> make_engine(const SimpleConfig& config, ThreadPool& pool) {
  return std::make_unique<Simple>(config, pool);
}

}  // namespace mosbench::odometry
