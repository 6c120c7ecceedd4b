#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/scene_cast.hpp"

namespace mosbench {

/// A scene at one instant: its bodies and the state of each owner by the number in its bodies.
/// Owner 0 is the ground; then follow structures, movers, doors and balls in the scene's order.
struct SceneSnapshot {
  std::vector<Solid> solids;
  std::vector<OwnerState> owners;
};

SceneSnapshot snapshot(const Scene& scene, double time_s);

}  // namespace mosbench
