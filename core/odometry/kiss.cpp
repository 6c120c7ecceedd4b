#include <algorithm>
#include <cmath>

#include "core/odometry/engine.hpp"
#include "core/odometry/point_grid.hpp"
#include "core/odometry/rigid_motion.hpp"

namespace mosbench::odometry {
namespace {

// Voxels of the points that enter the map and of those that are aligned, of the edge of the map's.
constexpr double kMapShare = 0.5, kAlignedShare = 1.5;
constexpr double kProbeShare = 0.5;  // how far beside a pose it is looked for, of that edge

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Points = std::span<const Eigen::Vector3d>;

/// The sums of a Gauss-Newton step over the matched points q with residuals r and weights w.
struct Sums {
  std::size_t matched = 0;
  double weight = 0;                                   // w
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // w q
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // w r
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();    // w q x r
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();    // w q q'

  void add(const Eigen::Vector3d& q, const Eigen::Vector3d& r, double w) {
    ++matched;
    weight += w;
    position += w * q;
    residual += w * r;
    torque += w * q.cross(r);
    moment += w * q * q.transpose();
  }
  void add(const Sums& other) {
    matched += other.matched;
    weight += other.weight;
    position += other.position;
    residual += other.residual;
    torque += other.torque;
    moment += other.moment;
  }

  /// The small rotation and translation of the map's frame that minimise sum w |r + omega x q +
  /// t|^2.
  Vector6d step() const {
    Matrix6d normal;
    normal.topLeftCorner<3, 3>() = moment.trace() * Eigen::Matrix3d::Identity() - moment;
    normal.topRightCorner<3, 3>() << 0, -position.z(), position.y(), position.z(), 0, -position.x(),
        -position.y(), position.x(), 0;
    normal.bottomLeftCorner<3, 3>() = normal.topRightCorner<3, 3>().transpose();
    normal.bottomRightCorner<3, 3>() = weight * Eigen::Matrix3d::Identity();
    Vector6d right;
    right << -torque, -residual;
    return normal.ldlt().solve(right);
  }
};

/// Point-to-point registration with an adaptive threshold: KISS-ICP (RA-L 2023).
class Kiss : public Engine {
 public:
  Kiss(const KissConfig& config, ThreadPool& pool)
      : config_(config),
        pool_(pool),
        map_(config.voxel_size_m),
        squares_m2_(config.initial_threshold_m * config.initial_threshold_m) {}

  void take(std::span<const Eigen::Vector3d> points_m) override {
    for_map_ = first_of_cells(points_m, kMapShare * config_.voxel_size_m);
    taken_ = first_of_cells(for_map_, kAlignedShare * config_.voxel_size_m);
    some_ = every_nth(taken_, 4);
  }
  std::span<const Eigen::Vector3d> taken() const override { return taken_; }
  std::span<const Eigen::Vector3d> surfaces() const override { return for_map_; }
  double spacing_m() const override { return kMapShare * config_.voxel_size_m; }

  Alignment align(const Pose& seed) const override { return align(taken_, seed); }
  Pose settled_from(const Pose& seed) const override { return align(some_, seed).map_from_sensor; }
  double probe_m() const override { return kProbeShare * config_.voxel_size_m; }

  std::optional<Eigen::Vector3d> nearest(const Eigen::Vector3d& position_m) const override {
    const Neighbour neighbour = map_.nearest_in_27_cells(position_m);
    if (!std::isfinite(neighbour.distance_m)) return std::nullopt;
    return neighbour.point_m;
  }

  void enter(const Pose& map_from_sensor) override {
    const double apart_m = config_.voxel_size_m / std::sqrt(config_.max_points_per_voxel);
    for (const Eigen::Vector3d& p : for_map_) {
      const Eigen::Vector3d q = map_from_sensor * p;
      int points = 0;
      bool near = false;
      map_.for_each_in_cell(q, [&](const Eigen::Vector3d& other) {
        ++points;
        near = near || (other - q).squaredNorm() < apart_m * apart_m;
      });
      if (points < config_.max_points_per_voxel && !near) map_.insert(q);
    }
    map_.keep_within(map_from_sensor.translation(), config_.scan.max_range_m);
  }

  void forget() override { map_.clear(); }

  void learn(const Pose& predicted_from_found) override {
    const double turn_rad = rotation_vector_of(predicted_from_found).norm();
    const double error_m = predicted_from_found.translation().norm() +
                           2 * config_.scan.max_range_m * std::sin(turn_rad / 2);
    if (!(error_m > config_.min_motion_m)) return;
    squares_m2_ += error_m * error_m;
    ++errors_;
  }

  std::size_t map_points() const override { return map_.size(); }
  std::size_t memory_bytes() const override {
    return map_.memory_bytes() +
           (taken_.capacity() + for_map_.capacity() + some_.capacity()) * sizeof(Eigen::Vector3d);
  }

 private:
  double sigma_m() const { return std::sqrt(squares_m2_ / static_cast<double>(errors_)); }

  Alignment align(Points points_m, const Pose& seed) const {
    Alignment result{.map_from_sensor = seed, .settled = false};
    std::size_t matched = 0;
    for (int step = 0; step < config_.max_iterations && !result.settled; ++step) {
      const Sums sums = sums_at(points_m, result.map_from_sensor);
      const Vector6d change = sums.step();
      matched = sums.matched;
      if (matched < 3 || !change.allFinite()) break;
      Pose moved = Pose::Identity();
      moved.linear() = rotation_about(change.head<3>());
      moved.translation() = change.tail<3>();
      result.map_from_sensor = rigid(moved * result.map_from_sensor);
      result.settled = change.norm() < config_.convergence;
    }
    result.overlap = static_cast<double>(matched) / static_cast<double>(points_m.size());
    return result;
  }

  Sums sums_at(Points points_m, const Pose& pose) const {
    std::vector<Sums> chunks((points_m.size() + kChunkPoints - 1) / kChunkPoints);
    pool_.for_ranges(
        points_m.size(), kChunkPoints, [&](std::size_t begin, std::size_t end, unsigned) {
          chunks[begin / kChunkPoints] = sums_of(points_m.subspan(begin, end - begin), pose);
        });
    Sums all;
    for (const Sums& chunk : chunks) all.add(chunk);
    return all;
  }

  Sums sums_of(Points points_m, const Pose& pose) const {
    const double sigma = sigma_m();
    Sums sums;
    for (const Eigen::Vector3d& p : points_m) {
      const Eigen::Vector3d q = pose * p;
      const Neighbour neighbour = map_.nearest_in_27_cells(q);
      if (!(neighbour.distance_m < 3 * sigma)) continue;
      // Geman and McClure's weight.
      const double spread = sigma + neighbour.distance_m * neighbour.distance_m;
      sums.add(q, q - neighbour.point_m, sigma * sigma / (spread * spread));
    }
    return sums;
  }

  KissConfig config_;
  ThreadPool& pool_;
  PointGrid map_;
  std::vector<Eigen::Vector3d> for_map_, taken_, some_;
  double squares_m2_;  // of the prediction's errors
  int errors_ = 1;
};

}  // namespace

std::unique_ptr<Engine> make_engine(const KissConfig& config, ThreadPool& pool) {
  return std::make_unique<Kiss>(config, pool);
}

}  // namespace mosbench::odometry
