#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/scene_cast.hpp"

namespace mosbench {

enum class Substance : std::uint8_t {
  kGround,
  kBuilding,
  kPole,
  kVegetation,
  kMoverBody,
  kDoor,
  kBall
};

/// The state of one part of a scene at one instant.
struct OwnerState {
  Substance substance = Substance::kGround;
  MoverKind mover = MoverKind::kPedestrian;  ///< of a kMoverBody
  bool labelled = true;
  bool moving = false;                 ///< its speed exceeds 0.5 m/s, of a vehicle 1.0 m/s
  bool dynamic_by_appearance = false;  ///< an annotator calls it dynamic although it stands
  double speed_m_s = 0.0;
  Eigen::Vector3d base_m = Eigen::Vector3d::Zero();  ///< of its bodies, which turn around it
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();   ///< unit vector, where its x points
};

/// A scene at one instant: its bodies and the state of each owner by the number in its bodies.
/// Owner 0 is the ground; then follow structures, movers, doors and balls in the scene's order.
struct SceneSnapshot {
  std::vector<Solid> solids;
  std::vector<OwnerState> owners;
};

SceneSnapshot snapshot(const Scene& scene, double time_s);

}  // namespace mosbench
