#include "eval/cli/odometry_flags.hpp"

#include <CLI/CLI.hpp>
#include <mosbench/odometry.hpp>
#include <span>
#include <vector>

#include "eval/cli/help_text.hpp"

namespace mosbench {
namespace {

constexpr const char* kOdometryGroup = "Poses found from the scans";

template <typename Row>
std::vector<std::string_view> names_of(std::span<const Row> rows) {
  std::vector<std::string_view> names;
  for (const Row& row : rows) names.push_back(row.name);
  return names;
}

}  // namespace

std::string odometry_type() { return type_of_names(names_of(odometries())); }

std::string odometry_preset_type() { return type_of_names(names_of(odometry_presets())); }

void add_odometry_flags(CLI::App& command, OdometryOptions& odometry) {
  command
      .add_option("--odometry", odometry.kind,
                  "Find the poses by it instead of reading them, see `mosbench list odometry`")
      ->type_name(odometry_type())
      ->group(kOdometryGroup);
  command.add_option("--odometry-preset", odometry.preset, "Settings that its authors published")
      ->type_name(odometry_preset_type())
      ->group(kOdometryGroup);
  command.add_option("--odometry-config", odometry.config_file, "JSON object of its settings")
      ->type_name("FILE")
      ->group(kOdometryGroup);
  command.add_option("--odometry-set", odometry.assignments, "One of its settings, per flag")
      ->type_name("KEY=VALUE")
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
