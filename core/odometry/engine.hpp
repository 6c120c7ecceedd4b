#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <mosbench/scan.hpp>
#include <span>

#include "core/base/thread_pool.hpp"
#include "core/odometry/config.hpp"

namespace mosbench::odometry {

/// What came of aligning a scan with the map.
struct Alignment {
  Pose map_from_sensor = Pose::Identity();
  double overlap = 0;           ///< share of the scan's points that lie where the map has points
  double effective_points = 0;  ///< sum of the weights that points had in the end
  double residual_m = 0;        ///< weighted root mean square distance to the map
  bool settled = true;          ///< false: stopped by its limit of steps
};

/// A way to align scans with a map of points that it keeps.
class Engine {
 public:
  virtual ~Engine() = default;

  /// Takes the points of the next scan: in range, sensor frame, in file order. Thins them.
  virtual void take(std::span<const Eigen::Vector3d> points_m) = 0;
  /// The thinned points that are to be aligned.
  virtual std::span<const Eigen::Vector3d> taken() const = 0;
  /// Points of the taken scan that show its surfaces, about `spacing_m` apart.
  virtual std::span<const Eigen::Vector3d> surfaces() const = 0;
  virtual double spacing_m() const = 0;
  /// Finds the pose of the taken scan. The map must not be empty.
  virtual Alignment align(const Pose& seed) const = 0;
  /// Enters the taken scan into the map and forgets what is out of range of it.
  virtual void enter(const Pose& map_from_sensor) = 0;
  /// Empties the map.
  virtual void forget() = 0;
  /// Says how far a predicted pose was off the one that was found.
  virtual void learn(const Pose& /*predicted_from_found*/) {}

  virtual std::size_t map_points() const = 0;
  virtual std::size_t memory_bytes() const = 0;
};

std::unique_ptr<Engine> make_engine(const SimpleConfig& config, ThreadPool& pool);
std::unique_ptr<Engine> make_engine(const KissConfig& config, ThreadPool& pool);

}  // namespace mosbench::odometry
