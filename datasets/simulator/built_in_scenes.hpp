#pragma once

#include <string_view>
#include <vector>

#include "datasets/simulator/scene.hpp"

namespace mosbench {

struct SceneSummary {
  std::string_view name;
  std::string_view content;  ///< one line for lists
};

/// The scenes that need no file, in the order in which to show them.
std::vector<SceneSummary> built_in_scenes();

/// Throws UsageError, with the nearest name, for a name that is not in the list.
Scene built_in_scene(std::string_view name);

}  // namespace mosbench
