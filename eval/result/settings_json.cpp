#include "eval/result/settings_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/nearest_name.hpp"
#include "eval/result/recorded_settings.hpp"

namespace mosbench {
namespace {

using json = nlohmann::ordered_json;

std::vector<std::string_view> names_of(const Settings& settings) {
  std::vector<std::string_view> names;
  for (const Setting& setting : settings.all()) names.push_back(setting.name);
  return names;
}

/// Nothing for a value that no setting can have.
std::optional<SettingValue> setting_value(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  // What does not fit an int is outside every range.
  const bool fits = std::abs(number) < 2e9;
  if (value.is_number_integer() && fits) return value.get<int>();
  return number;
}

/// Throws std::invalid_argument for a value of another type or outside its range.
void set_value(const Setting& setting, const json& value, Settings& settings) {
  const auto refuse = [&](std::string_view wrong) {
    const std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    throw std::invalid_argument(
        fmt::format("{}: {} {}, expected {}", setting.name, text, wrong, legal_values(setting)));
  };
  const std::optional<SettingValue> wanted = setting_value(value);
  if (!wanted) refuse("is not a number");
  if (value.is_number_integer() && !std::holds_alternative<int>(*wanted)) {
    refuse("is out of range");
  }
  settings.set(setting.name, *wanted);
}

void apply_value(std::string_view key, const json& value, std::string_view origin,
                 Settings& settings) {
  const Setting* setting = settings.find(key);
  if (setting == nullptr) {
    const std::vector<std::string_view> names = names_of(settings);
    throw UsageError(fmt::format("{}: key '{}' is not known, expected one of {} (nearest: {})",
                                 origin, key, fmt::join(names, ", "), nearest_name(key, names)));
  }
  try {
    set_value(*setting, value, settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: {}", origin, error.what()));
  }
}

/// What is wrong with a configuration is wrong usage.
json parse_settings(std::string_view text, std::string_view origin) {
  try {
    return parse_json(text, origin);
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

std::vector<std::string> apply_settings_text(std::string_view text, std::string_view origin,
                                             Settings& settings) {
  const json object = parse_settings(text, origin);
  if (!object.is_object()) {
    throw UsageError(fmt::format("{}: holds a {}, expected a JSON object with configuration keys",
                                 origin, object.type_name()));
  }
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) {
    apply_value(key, value, origin, settings);
    keys.push_back(key);
  }
  return keys;
}

std::vector<std::string> apply_settings_file(const std::filesystem::path& file,
                                             Settings& settings) {
  std::string text;
  try {
    text = read_file(file);
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
  return apply_settings_text(text, file.string(), settings);
}

void apply_setting_assignment(std::string_view assignment, Settings& settings) {
  const std::string origin = fmt::format("--set {}", assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw UsageError(origin + ": has no key and value, expected key=value");
  }
  const std::string_view value = assignment.substr(equals + 1);
  json parsed = std::string(value);
  try {
    parsed = parse_json(value, origin);
  } catch (const DataError&) {  // a name
  }
  apply_value(assignment.substr(0, equals), parsed, origin, settings);
}

nlohmann::ordered_json to_json(const Settings& settings) {
  return to_json(RecordedSettings(settings));
}

}  // namespace mosbench
