#include "core/odometry/simple_cost.hpp"

#include <algorithm>
#include <cmath>

#include "core/odometry/engine.hpp"
#include "core/odometry/point_grid.hpp"

namespace mosbench::odometry {
namespace {

constexpr double kFarAway_m = 1e6;
// So that rounding cannot let a point go farther than it may.
constexpr double kRounding_m = 1e-9;

constexpr double kDifference = 1e-7;  // of radians and of metres

// How far points move on average in the first trial of a search, at most.
constexpr double kFirstMotionSigmas = 1.0;

double falloff_per_m2(double sigma_m) { return std::pow(sigma_m, -2) / 2; }

/// The derivatives of R = Rz(yaw) Ry(pitch) Rx(roll) by the three angles.
std::array<Eigen::Matrix3d, 3> rotation_derivatives(const Vector6d& state) {
  const double cr = std::cos(state[0]), sr = std::sin(state[0]);
  const double cp = std::cos(state[1]), sp = std::sin(state[1]);
  const double cy = std::cos(state[2]), sy = std::sin(state[2]);
  std::array<Eigen::Matrix3d, 3> by;
  by[0] << 0, cy * sp * cr + sy * sr, -cy * sp * sr + sy * cr,  //
      0, sy * sp * cr - cy * sr, -sy * sp * sr - cy * cr,       //
      0, cp * cr, -cp * sr;
  by[1] << -cy * sp, cy * cp * sr, cy * cp * cr,  //
      -sy * sp, sy * cp * sr, sy * cp * cr,       //
      -cp, -sp * sr, -sp * cr;
  by[2] << -sy * cp, -sy * sp * sr - cy * cr, -sy * sp * cr + cy * sr,  //
      cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,          //
      0, 0, 0;
  return by;
}

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

Correspondences::Correspondences(std::size_t points, const PointGrid& map, double reach_m)
    : map_(map), reach_m_(reach_m), tracked_(points) {}

void Correspondences::search(Tracked& tracked, const Eigen::Vector3d& position_m) const {
  const Neighbour neighbour = map_.nearest(position_m, reach_m_);
  const bool found = std::isfinite(neighbour.distance_m);
  tracked.asked_m = position_m;
  tracked.nearest_m =
      found ? neighbour.point_m : position_m + Eigen::Vector3d::Constant(kFarAway_m);
  const double free_m =
      found ? (neighbour.others_m - neighbour.distance_m) / 2 : neighbour.others_m - reach_m_;
  const double safe_m = std::max(free_m - kRounding_m, 0.0);
  tracked.free_sq_m2 = safe_m * safe_m;
}

NumericCost::NumericCost(const SimpleProblem& problem, ThreadPool& pool)
    : problem_(problem),
      pool_(pool),
      nearest_(problem.points_m.size(), problem.map, problem.reach_m),
      closeness_(problem.points_m.size()) {}

double NumericCost::value(const Vector6d& at) {
  const Pose pose = pose_of(at);
  const double falloff = falloff_per_m2(problem_.sigma_m);
  pool_.for_ranges(
      closeness_.size(), kChunkPoints, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i) {
          const Eigen::Vector3d q = moved(pose, problem_.points_m[i]);
          const Eigen::Vector3d r = q - nearest_.nearest(i, q);
          closeness_[i] = std::exp(-(r.x() * r.x() + r.y() * r.y() + r.z() * r.z()) * falloff);
        }
      });
  double sum = 0;
  for (const double closeness : closeness_) sum += closeness;
  return -sum;
}

Vector6d NumericCost::gradient(const Vector6d& at) {
  Vector6d gradient;
  for (Eigen::Index i = 0; i < 6; ++i) {
    Vector6d low = at, high = at;
    low[i] -= kDifference;
    high[i] += kDifference;
    gradient[i] = (value(high) - value(low)) / (high[i] - low[i]);
  }
  return gradient;
}

double NumericCost::slope(const Vector6d& at, const Vector6d& direction, double step) {
  const double low = step - kDifference, high = step + kDifference;
  return (value(at + high * direction) - value(at + low * direction)) / (high - low);
}

AnalyticCost::AnalyticCost(const SimpleProblem& problem, ThreadPool& pool)
    : problem_(problem),
      pool_(pool),
      nearest_(problem.points_m.size(), problem.map, problem.reach_m),
      chunks_((problem.points_m.size() + kChunkPoints - 1) / kChunkPoints) {
  for (const Eigen::Vector3d& p : problem_.points_m) mean_range_m_ += p.norm();
  mean_range_m_ /= static_cast<double>(std::max<std::size_t>(problem_.points_m.size(), 1));
}

AnalyticCost::Sums AnalyticCost::sums_of(std::size_t begin, std::size_t end, const Pose& pose) {
  const double falloff = falloff_per_m2(problem_.sigma_m);
  Sums sums;
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::Vector3d& p = problem_.points_m[i];
    const Eigen::Vector3d q = moved(pose, p);
    const Eigen::Vector3d residual = q - nearest_.nearest(i, q);
    const double closeness = std::exp(-falloff * residual.squaredNorm());
    const Eigen::Vector3d pull = closeness * residual;
    sums.closeness += closeness;
    sums.residual += pull;
    sums.moment += pull * p.transpose();
  }
  return sums;
}

void AnalyticCost::evaluate(const Vector6d& at) {
  if (evaluated_at_ == at) return;
  const Pose pose = pose_of(at);
  pool_.for_ranges(problem_.points_m.size(), kChunkPoints,
                   [&](std::size_t begin, std::size_t end, unsigned) {
                     chunks_[begin / kChunkPoints] = sums_of(begin, end, pose);
                   });
  Sums all;
  for (const Sums& chunk : chunks_) {
    all.closeness += chunk.closeness;
    all.residual += chunk.residual;
    all.moment += chunk.moment;
  }
  const double scale = 2 * falloff_per_m2(problem_.sigma_m);
  const std::array<Eigen::Matrix3d, 3> by_angle = rotation_derivatives(at);
  for (std::size_t j = 0; j < 3; ++j) {
    gradient_[static_cast<Eigen::Index>(j)] = scale * all.moment.cwiseProduct(by_angle[j]).sum();
  }
  gradient_.tail<3>() = scale * all.residual;
  value_ = -all.closeness;
  evaluated_at_ = at;
}

double AnalyticCost::first_step(const Vector6d& direction) const {
  const double motion_m = direction.head<3>().norm() * mean_range_m_ + direction.tail<3>().norm();
  return std::min(1.0, kFirstMotionSigmas * problem_.sigma_m / std::max(motion_m, kDifference));
}

double AnalyticCost::value(const Vector6d& at) {
  evaluate(at);
  return value_;
}

Vector6d AnalyticCost::gradient(const Vector6d& at) {
  evaluate(at);
  return gradient_;
}

double AnalyticCost::slope(const Vector6d& at, const Vector6d& direction, double step) {
  evaluate(at + step * direction);
  return gradient_.dot(direction);
}

std::unique_ptr<Engine> make_engine(const SimpleConfig& config, ThreadPool& pool) {
  return std::make_unique<Simple>(config, pool);
}

}  // namespace mosbench::odometry
