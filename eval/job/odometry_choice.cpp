#include "eval/job/odometry_choice.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "eval/job/method_choice.hpp"
#include "eval/result/settings_json.hpp"

namespace mosbench {
namespace {

void apply_odometry_preset(const std::string& name, const OdometryKind& kind, Settings& settings) {
  const OdometryPreset& preset = row_named(odometry_presets(), name, "preset of odometry");
  if (preset.odometry != kind.name) {
    throw UsageError(fmt::format("preset of odometry: {} is of {}, expected one of {}", name,
                                 preset.odometry, kind.name));
  }
  for (const auto& [key, value] : preset.settings) settings.set(key, value);
}

std::string settings_text(const Settings& settings) {
  std::vector<std::string> words;
  for (const Setting& setting : settings.all()) {
    words.push_back(fmt::format("{}={}", setting.name, to_string(setting.value)));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace

bool OdometryOptions::says_anything() const {
  return preset || config_file || !assignments.empty() || drop_moving;
}

OdometryChoice choose_odometry(const OdometryOptions& options, const Reading& reading) {
  const std::string name = options.kind.value_or(std::string(odometries().front().name));
  OdometryChoice choice{.kind = &row_named(odometries(), name, "--odometry"), .settings = {}};
  choice.settings = choice.kind->defaults;
  if (options.preset) apply_odometry_preset(*options.preset, *choice.kind, choice.settings);
  if (options.config_file) apply_settings_file(*options.config_file, choice.settings);
  if (reading.deskew) {
    choice.deskew = *reading.deskew;
    choice.says_deskew = true;
    choice.settings.set("deskew", std::string(to_string(choice.deskew)));
  }
  choice.drop_moving = options.drop_moving;
  for (const std::string& assignment : options.assignments) {
    apply_setting_assignment(assignment, choice.settings);
  }
  try {
    choice.kind->check(choice.settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("odometry: {}", error.what()));
  }
  return choice;
}

std::optional<OdometryChoice> named_odometry(const OdometryOptions& odometry,
                                             const Reading& reading) {
  if (!odometry.kind) {
    if (!odometry.says_anything()) return std::nullopt;
    throw UsageError("--odometry: is missing, expected simple or kiss before its settings");
  }
  if (reading.pose_file() != nullptr) {
    throw UsageError("--poses and --odometry: say where poses come from, expected one of them");
  }
  return choose_odometry(odometry, reading);
}

MovingFilter moving_filter(const MethodKind& method, Settings settings) {
  if (settings.find(common_settings::kDelay_scans) != nullptr) {
    settings.set(common_settings::kDelay_scans, 0);
  }
  try {
    method.check(settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("drop_moving: needs method {} with delay_scans=0: {}", method.name,
                                 error.what()));
  }
  return {&method, std::move(settings)};
}

OdometryDone odometry_done(const OdometryChoice& choice) {
  OdometryDone done{
      fmt::format("odometry {}", choice.kind->name), RecordedSettings(choice.settings), {}};
  if (choice.filter) {
    done.map = fmt::format("without what {} finds moving: {}", choice.filter->method->name,
                           settings_text(choice.filter->settings));
  }
  return done;
}

PosesDone statement_of(const OdometryChoice& choice) {
  const OdometryDone done = odometry_done(choice);
  return {.source = done.name, .odometry = settings_text(choice.settings), .map = done.map};
}

}  // namespace mosbench
