#include "eval/result/settings_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mosbench/method.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "datasets/disk/files.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::optional<double> number_in(const SettingValue& value) {
  if (const int* whole = std::get_if<int>(&value)) return *whole;
  if (const double* number = std::get_if<double>(&value)) return *number;
  return std::nullopt;
}

/// Nothing for a value that no setting can have.
std::optional<SettingValue> setting_value(const ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  // What does not fit an int is outside every range, and kept as the number it is.
  const bool fits = std::abs(number) < std::numeric_limits<int>::max();
  if (value.is_number_integer() && fits) return value.get<int>();
  return number;
}

/// Throws std::invalid_argument for a value of another type or outside its range.
void set_value(const Setting& setting, const ordered_json& value, Settings& settings) {
  const auto refuse = [&](std::string_view wrong) {
    const std::string text = value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
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

void apply_value(std::string_view key, const ordered_json& value, std::string_view origin,
                 Settings& settings) {
  const Setting* setting = settings.find(key);
  if (setting == nullptr) {
    std::vector<std::string_view> names;
    for (const Setting& known : settings.all()) names.push_back(known.name);
    throw UsageError(fmt::format("{}: key '{}' is not known, expected one of {} (nearest: {})",
                                 origin, key, fmt::join(names, ", "), nearest_name(key, names)));
  }
  try {
    set_value(*setting, value, settings);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("{}: {}", origin, error.what()));
  }
}

/// Does some work, in which what is wrong with a file is wrong usage.
auto blaming_user(auto&& work) {
  try {
    return work();
  } catch (const DataError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

RecordedSettings::RecordedSettings(const Settings& settings) {
  for (const Setting& setting : settings.all()) {
    SettingValue value;
    if (std::holds_alternative<std::string>(setting.value)) {
      value = settings.choice(setting.name);
    } else if (std::holds_alternative<int>(setting.value)) {
      value = settings.whole(setting.name);
    } else {
      value = settings.number(setting.name);
    }
    entries_.emplace_back(setting.name, std::move(value));
  }
}

const SettingValue* RecordedSettings::find(std::string_view name) const {
  const auto found = std::ranges::find(entries_, name, &Entry::first);
  return found == entries_.end() ? nullptr : &found->second;
}

double RecordedSettings::number(std::string_view name, double otherwise) const {
  const SettingValue* value = find(name);
  return value == nullptr ? otherwise : number_in(*value).value_or(otherwise);
}

std::string RecordedSettings::word(std::string_view name) const {
  const SettingValue* value = find(name);
  return value == nullptr || number_in(*value) ? "" : std::get<std::string>(*value);
}

void RecordedSettings::set(std::string_view name, const SettingValue& value) {
  const auto found = std::ranges::find(entries_, name, &Entry::first);
  if (found != entries_.end()) {
    found->second = value;
  } else {
    entries_.emplace_back(name, value);
  }
}

bool RecordedSettings::operator==(const RecordedSettings& other) const {
  return std::ranges::equal(entries_, other.entries_, [](const Entry& a, const Entry& b) {
    return a.first == b.first && are_equal(a.second, b.second);
  });
}

bool are_equal(const SettingValue& one, const SettingValue& other) {
  const std::optional<double> number = number_in(one);
  return number ? number == number_in(other) : one == other;
}

std::string value_text(const SettingValue& value) {
  const auto* word = std::get_if<std::string>(&value);
  return word == nullptr ? to_json(value).dump() : *word;
}

ordered_json to_json(const SettingValue& value) {
  return std::visit([](const auto& held) { return ordered_json(held); }, value);
}

ordered_json to_json(const RecordedSettings& settings) {
  ordered_json json = ordered_json::object();
  for (const auto& [name, value] : settings.all()) json[name] = to_json(value);
  return json;
}

RecordedSettings recorded_settings(const ordered_json& json) {
  RecordedSettings settings;
  for (const auto& [name, value] : json.get_ref<const ordered_json::object_t&>()) {
    const std::optional<SettingValue> held = setting_value(value);
    if (!held) throw std::invalid_argument(name + ": " + value.dump() + " is no value");
    settings.set(name, *held);
  }
  return settings;
}

void check_recorded_settings(const RecordedSettings& settings, std::string_view method) {
  const MethodKind* kind = find_method(method);
  if (kind == nullptr) return;
  Settings checked = kind->defaults;
  for (const auto& [name, value] : settings.all()) {
    // A setting of another version is not known.
    if (checked.find(name) != nullptr) checked.set(name, value);
  }
}

std::string describe_settings(const RecordedSettings& settings, std::string_view method) {
  const MethodKind* kind = find_method(method);
  std::vector<std::string> parts;
  std::set<std::string_view> said;
  const auto has = [&](std::string_view name) {
    said.insert(name);
    return settings.find(name) != nullptr;
  };
  const auto number = [&](std::string_view name) { return settings.number(name, 0.0); };
  if (has(common_settings::kVariant)) parts.push_back(settings.word(common_settings::kVariant));
  if (has(common_settings::kVoxelSize_m)) {
    parts.push_back(fmt::format("voxel {:g} m", number(common_settings::kVoxelSize_m)));
  }
  if (has(common_settings::kMinRange_m) && has(common_settings::kMaxRange_m)) {
    parts.push_back(fmt::format("range {:g} to {:g} m", number(common_settings::kMinRange_m),
                                number(common_settings::kMaxRange_m)));
  }
  if (has(common_settings::kDelay_scans)) {
    const auto delay_scans = static_cast<int>(number(common_settings::kDelay_scans));
    const double window_s =
        has(common_settings::kTrackWindow_s) ? number(common_settings::kTrackWindow_s) : 0;
    parts.push_back(window_s > 0       ? fmt::format("whole tracks within {:g} s", window_s)
                    : delay_scans == 0 ? "online"
                                       : "delayed by " + counted(delay_scans, "scan"));
  }
  for (const auto& [name, value] : settings.all()) {
    if (said.contains(name)) continue;
    // Usual is the value of the setting that this one follows, or the method's default.
    const Setting* setting = kind == nullptr ? nullptr : kind->defaults.find(name);
    const bool follows = setting != nullptr && !setting->follows.empty();
    const SettingValue* usual = follows              ? settings.find(setting->follows)
                                : setting == nullptr ? nullptr
                                                     : &setting->value;
    if (usual != nullptr && are_equal(*usual, value)) continue;
    parts.push_back(fmt::format("{} {}", name, value_text(value)));
  }
  if (parts.empty()) return settings.all().empty() ? "" : "default settings";
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<std::string> apply_settings_text(std::string_view text, std::string_view origin,
                                             Settings& settings) {
  const ordered_json object = blaming_user([&] { return parse_json(text, origin); });
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
  const std::string text = blaming_user([&] { return read_file(file); });
  return apply_settings_text(text, file.string(), settings);
}

void apply_setting_assignment(std::string_view assignment, Settings& settings) {
  const std::string origin = fmt::format("--set {}", assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw UsageError(origin + ": has no key and value, expected key=value");
  }
  const std::string_view value = assignment.substr(equals + 1);
  ordered_json parsed = std::string(value);
  try {
    parsed = parse_json(value, origin);
  } catch (const DataError&) {  // a name
  }
  if (parsed.is_boolean()) parsed = std::string(value);
  apply_value(assignment.substr(0, equals), parsed, origin, settings);
}

nlohmann::ordered_json to_json(const Settings& settings) {
  return to_json(RecordedSettings(settings));
}

}  // namespace mosbench
