#pragma once

#include <CLI/App.hpp>
#include <string>

#include "eval/job/method_choice.hpp"

namespace mosbench {

/// Adds --odometry KIND[:PRESET][,KEY=VALUE,...], which says how poses are found. Of what it does
/// `description` says the first half.
void add_odometry_flag(CLI::App& command, OdometryOptions& odometry,
                       const std::string& description);

}  // namespace mosbench
