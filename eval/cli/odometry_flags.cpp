#include "eval/cli/odometry_flags.hpp"

#include <CLI/CLI.hpp>

namespace mosbench {
namespace {

constexpr const char* kOdometryGroup = "Poses found from the scans";

}  // namespace

void add_odometry_flags(CLI::App& command, OdometryOptions& odometry) {
  command
      .add_option("--odometry", odometry.kind,
                  "simple or kiss: find the poses instead of reading them")
      ->group(kOdometryGroup);
  command.add_option("--odometry-preset", odometry.preset, "Settings that its authors published")
      ->group(kOdometryGroup);
  command.add_option("--odometry-config", odometry.config_file, "JSON object of its settings")
      ->group(kOdometryGroup);
  command.add_option("--odometry-set", odometry.assignments, "key=value, one per flag")
      ->allow_extra_args(false)
      ->group(kOdometryGroup);
  add_drop_moving_flag(command, odometry);
}

void add_drop_moving_flag(CLI::App& command, OdometryOptions& odometry) {
  command
      .add_flag("--drop-moving", odometry.drop_moving,
                "Register scans to a map without the points that moved in earlier ones")
      ->group(kOdometryGroup);
}

}  // namespace mosbench
