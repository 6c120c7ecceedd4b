#pragma once

#include <CLI/App.hpp>
#include <string>

#include "eval/engine/odometry_choice.hpp"

namespace mosbench {

/// The names of kinds and of presets, as `type_of_names`.
std::string odometry_type();
std::string odometry_preset_type();

/// Adds --odometry and the flags of its settings to a command that otherwise reads poses. What they
/// fill must outlive the parsing.
void add_odometry_flags(CLI::App& command, OdometryOptions& odometry);
/// Adds --drop-moving alone.
void add_drop_moving_flag(CLI::App& command, OdometryOptions& odometry);

}  // namespace mosbench
