#pragma once

#include <memory>
#include <mosbench/method.hpp>
#include <string_view>

#include "core/methods/octomap/config.hpp"

namespace mosbench::octomap {

/// Returns the method on OctoMap's map: points move whose voxel was observed and is free. Scores
/// are minus the log-odds of a point's voxel, 0 where it was never observed; points move above 0.
/// Voxels farther than two ranges from the sensor are forgotten; `final` keeps all and labels every
/// scan at the end. Throws std::invalid_argument as `check` does, and for 0 threads; without the
/// library always.
std::unique_ptr<Method> make_pipeline(const Config& config, const RunContext& context = {});

/// Returns how to build with the library; empty in a build that has it.
std::string_view how_to_build();

}  // namespace mosbench::octomap
