#pragma once

#include <mosbench/method.hpp>

namespace mosbench::octomap {

/// "octomap": points in voxels that OctoMap holds free.
MethodKind method_kind();

}  // namespace mosbench::octomap
