#include "eval/result/recorded_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mosbench/method.hpp>
#include <optional>
#include <set>
#include <stdexcept>

#include "datasets/text/counted.hpp"

namespace mosbench {
namespace {

using nlohmann::ordered_json;

std::optional<double> number_in(const SettingValue& value) {
  if (const int* whole = std::get_if<int>(&value)) return *whole;
  if (const double* number = std::get_if<double>(&value)) return *number;
  return std::nullopt;
}

/// The value that a setting has while a result does not say another: that of the setting it
/// follows, or the method's default.
std::optional<SettingValue> usual_value(const RecordedSettings& settings, const Settings& defaults,
                                        std::string_view name) {
  const Setting* setting = defaults.find(name);
  if (setting == nullptr) return std::nullopt;
  if (setting->follows.empty()) return setting->value;
  const SettingValue* followed = settings.find(setting->follows);
  return followed == nullptr ? std::nullopt : std::optional(*followed);
}

}  // namespace

RecordedSettings::RecordedSettings(const Settings& settings) {
  for (const Setting& setting : settings.all()) {
    SettingValue value;
    if (!setting.choices.empty()) {
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
  if (found == entries_.end()) {
    entries_.emplace_back(name, value);
  } else {
    found->second = value;
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
    if (value.is_string()) {
      settings.set(name, value.get<std::string>());
      continue;
    }
    if (!value.is_number())
      throw std::invalid_argument(name + ": " + value.dump() + " is no value");
    // What does not fit an int is kept as the number it is.
    const auto number = value.get<double>();
    const bool is_whole =
        value.is_number_integer() && std::abs(number) < std::numeric_limits<int>::max();
    if (is_whole) {
      settings.set(name, value.get<int>());
    } else {
      settings.set(name, number);
    }
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
    parts.push_back(delay_scans == 0 ? "online" : "delayed by " + counted(delay_scans, "scan"));
  }
  for (const auto& [name, value] : settings.all()) {
    const auto usual = kind == nullptr ? std::nullopt : usual_value(settings, kind->defaults, name);
    if (said.contains(name) || (usual && are_equal(*usual, value))) continue;
    parts.push_back(fmt::format("{} {}", name, value_text(value)));
  }
  if (parts.empty()) return settings.all().empty() ? "" : "default settings";
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace mosbench
