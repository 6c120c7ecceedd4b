#pragma once

#include <string_view>
#include <vector>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

struct SceneSummary {
  std::string_view name;
  std::string_view content;  ///< one line for lists
};

/// Returns the scenes that need no file, in the order in which they are listed.
std::vector<SceneSummary> built_in_scenes();

/// Returns a scene by name. Throws UsageError with the nearest name for an unknown one.
Scene built_in_scene(std::string_view name);

}  // namespace mosbench
