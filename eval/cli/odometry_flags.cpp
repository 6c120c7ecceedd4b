#include "eval/cli/odometry_flags.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <mosbench/odometry.hpp>
#include <sstream>
#include <string_view>

#include "datasets/text/errors.hpp"
#include "eval/cli/help_text.hpp"

namespace mosbench {
namespace {

void take_part(const std::string& part, OdometryOptions& odometry) {
  constexpr std::string_view kDropMoving = "drop_moving=";
  if (part.starts_with('@')) {
    odometry.config_file = part.substr(1);
  } else if (part.starts_with(kDropMoving)) {
    const std::string word = part.substr(kDropMoving.size());
    if (word != "on" && word != "off") {
      throw UsageError(fmt::format("--odometry {}: expected on or off", part));
    }
    odometry.drop_moving = word == "on";
  } else if (part.find('=') != std::string::npos) {
    odometry.assignments.push_back(part);
  } else if (!odometry.kind && !odometry.preset) {
    const std::size_t colon = part.find(':');
    if (colon > 0) odometry.kind = part.substr(0, colon);
    if (colon != std::string::npos) odometry.preset = part.substr(colon + 1);
  } else {
    throw UsageError(fmt::format("--odometry {}: has no value, expected key=value", part));
  }
}

}  // namespace

void add_odometry_flag(CLI::App& command, OdometryOptions& odometry,
                       const std::string& description) {
  std::vector<std::string_view> kinds;
  for (const OdometryKind& kind : odometries()) kinds.push_back(kind.name);
  command
      .add_option_function<std::string>(
          "--odometry",
          [&odometry](const std::string& text) {
            std::istringstream parts(text);
            for (std::string part; std::getline(parts, part, ',');) take_part(part, odometry);
          },
          description + ": KIND[:PRESET][,KEY=VALUE,...], see `mosbench list odometry`")
      ->type_name(type_of_names(kinds));
}

}  // namespace mosbench
