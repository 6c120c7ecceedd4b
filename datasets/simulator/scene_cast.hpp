#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

/// One convex body at one instant. Boxes turn about z, cylinders stand upright.
struct Solid {
  Shape shape = Shape::kBox;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Ones();
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();  ///< unit vector of a box's x
  double density = 1.0;                             ///< as Structure::density
  double leaves_at_m = 0.0;                         ///< from where they hang still, along x
  double let_through = 0.0;                         ///< as Structure::let_through
  bool mirrors = false;                             ///< as Structure::mirrors
  std::uint32_t owner = 0;                          ///< meaning is the caller's
};

struct RayHit {
  double range_m = 0.0;
  std::uint32_t owner = 0;
  const Solid* mirror = nullptr;  ///< the owner's, where it mirrors
};

/// Finds the first body along rays that all start at one origin. Bodies are sorted into sectors of
/// azimuth about the origin, so a ray meets only those that it can hit.
class SceneCast {
 public:
  /// `solids` must outlive the object. Bodies farther than `max_range_m` are left out; bodies
  /// around the origin are transparent. The planes' owner is `ground_owner`; they rise and fall by
  /// up to `bumps_m`.
  SceneCast(std::span<const GroundPlane> ground, std::uint32_t ground_owner,
            std::span<const Solid> solids, const Eigen::Vector3d& origin_m, double max_range_m,
            double bumps_m = 0.0);

  /// `direction` is a unit vector; `ray_word` decides how vegetation and glass let this ray
  /// through.
  std::optional<RayHit> first_hit(const Eigen::Vector3d& direction, std::uint64_t ray_word) const;

 private:
  // A body as seen from the origin, in the body's own axes.
  struct Candidate {
    const Solid* solid;
    Eigen::Vector3d origin_m;
    double nearest_m;  // horizontal distance that no part of the body undercuts
  };

  void sort_into_sectors(std::span<const Solid> solids);
  bool reach_ground(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                    RayHit& best) const;
  void enter(const Candidate& candidate, const Eigen::Vector3d& direction, std::uint64_t ray_word,
             RayHit& best) const;
  std::optional<RayHit> reflected(const RayHit& hit, const Eigen::Vector3d& direction,
                                  std::uint64_t ray_word) const;

  std::span<const GroundPlane> ground_;
  std::uint32_t ground_owner_;
  Eigen::Vector3d origin_m_;
  double max_range_m_;
  double bumps_m_;
  std::vector<Candidate> candidates_;         // by growing nearest_m
  std::vector<std::uint32_t> sector_begins_;  // into sector_members_, one more than sectors
  std::vector<std::uint32_t> sector_members_;
};

/// A scene at one instant: its bodies and the state of each owner by the number in its bodies.
/// Owner 0 is the ground; then follow structures, movers, doors and balls in the scene's order.
struct SceneSnapshot {
  std::vector<Solid> solids;
  std::vector<OwnerState> owners;
};

SceneSnapshot snapshot(const Scene& scene, double time_s);

}  // namespace mosbench
