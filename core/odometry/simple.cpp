#include <algorithm>
#include <cmath>

#include "core/odometry/engine.hpp"
#include "core/odometry/simple_cost.hpp"
#include "core/odometry/thinning.hpp"

namespace mosbench::odometry {
namespace {

// exp(-10^2 / 2) = 2e-22: farther neighbours change no digit of the cost.
constexpr double kReachSigmas = 10.0;

/// SiMpLE: Simple Mapping and Localisation Estimation (IJRR 2024).
class Simple : public Engine {
 public:
  Simple(const SimpleConfig& config, ThreadPool& pool)
      : config_(config), pool_(pool), map_(config.map_radius_m) {}

  void take(std::span<const Eigen::Vector3d> points_m) override {
    taken_ = thinned(points_m, config_.scan_radius_m);
  }
  std::span<const Eigen::Vector3d> taken() const override { return taken_; }
  std::span<const Eigen::Vector3d> surfaces() const override { return taken_; }
  double spacing_m() const override { return config_.scan_radius_m; }

  Alignment align(const Pose& seed) const override {
    const SimpleProblem problem{
        .points_m = taken_,
        .map = map_,
        .sigma_m = config_.sigma_m,
        .reach_m = std::max(kReachSigmas * config_.sigma_m, config_.map_radius_m)};
    if (config_.gradient == Gradient::kNumeric) {
      NumericCost cost(problem, pool_);
      return aligned(minimise(cost, angles_of(seed), config_.tolerance));
    }
    AnalyticCost cost(problem, pool_);
    return aligned(minimise(cost, angles_of(seed), config_.tolerance));
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
    return map_.memory_bytes() + taken_.capacity() * sizeof(Eigen::Vector3d);
  }

 private:
  Alignment aligned(const Minimum& minimum) const {
    Alignment result{.map_from_sensor = pose_of(minimum.at), .settled = minimum.settled};
    std::size_t overlapping = 0;
    double squares_m2 = 0;
    for (const Eigen::Vector3d& p : taken_) {
      const double distance_m =
          map_.nearest(moved(result.map_from_sensor, p), config_.map_radius_m).distance_m;
      if (!(distance_m < config_.map_radius_m)) continue;
      ++overlapping;
      const double sigmas = distance_m / config_.sigma_m;
      const double weight = std::exp(-0.5 * sigmas * sigmas);
      result.effective_points += weight;
      squares_m2 += weight * distance_m * distance_m;
    }
    result.overlap = static_cast<double>(overlapping) / static_cast<double>(taken_.size());
    if (result.effective_points > 0) {
      result.residual_m = std::sqrt(squares_m2 / result.effective_points);
    }
    return result;
  }

  SimpleConfig config_;
  ThreadPool& pool_;
  PointGrid map_;
  std::vector<Eigen::Vector3d> taken_;
};

}  // namespace

std::unique_ptr<Engine> make_engine(const SimpleConfig& config, ThreadPool& pool) {
  return std::make_unique<Simple>(config, pool);
}

}  // namespace mosbench::odometry
