#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>

#include "core/base/thread_pool.hpp"
#include "core/odometry/config.hpp"

namespace mosbench::odometry {

/// Points that are summed at a time: fixed, so that sums do not depend on threads.
inline constexpr std::size_t kChunkPoints = 512;

/// The outcome of aligning a scan with the map.
struct Alignment {
  Pose map_from_sensor = Pose::Identity();
  double overlap = 0;   ///< share of the scan's points that lie where the map has points
  bool settled = true;  ///< false: stopped by its limit of steps
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
  /// Returns the pose that some of the points find from a seed. From `probe_m` beside the pose of
  /// all points they come back to it, unless several poses fit: on flat ground the points of equal
  /// beams fit wherever the sensor is.
  virtual Pose settled_from(const Pose& seed) const = 0;
  virtual double probe_m() const = 0;
  /// The map point nearest to a position in the map's frame; nothing where there is none near.
  virtual std::optional<Eigen::Vector3d> nearest(const Eigen::Vector3d& position_m) const = 0;
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
