#pragma once

#include <array>
#include <cstddef>
#include <mosbench/settings.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// Turns the config struct of a method into Settings and back. A config has one list of its fields,
/// visit_fields(config, visit), with one of these calls per field:
///
///     visit("voxel_size_m", config.voxel_size_m, FieldRange{0.01, 10.0}, "edge of a voxel");
///     visit("variant", config.variant, kVariantNames, "an enum with its names in order");
namespace mosbench {

/// Closed interval of the legal values of a number. `follows` names the field whose value stands
/// for an optional that is not set.
struct FieldRange {
  double lowest, highest;
  std::string_view follows = {};
};

/// Returns the fields of a config with their values.
template <typename Config>
Settings settings_of(const Config& config) {
  std::vector<Setting> settings;
  visit_fields(config, [&](std::string_view name, const auto& field, const auto& legal,
                           std::string_view meaning) {
    using Field = std::decay_t<decltype(field)>;
    Setting& setting = settings.emplace_back();
    setting.name = name;
    setting.meaning = meaning;
    if constexpr (std::is_enum_v<Field>) {
      setting.choices.assign(legal.begin(), legal.end());
      setting.value = std::string(legal[static_cast<std::size_t>(field)]);
    } else {
      setting.lowest = legal.lowest;
      setting.highest = legal.highest;
      setting.follows = legal.follows;
      if constexpr (std::is_same_v<Field, std::optional<double>>) {
        setting.is_set = field.has_value();
        setting.value = field.value_or(0.0);
      } else {
        setting.value = field;
      }
    }
  });
  return Settings(std::move(settings));
}

/// Returns the config that `settings`, which `settings_of` made of such a config, describe.
template <typename Config>
Config config_of(const Settings& settings) {
  Config config;
  visit_fields(config,
               [&](std::string_view name, auto& field, const auto& legal, std::string_view) {
                 using Field = std::decay_t<decltype(field)>;
                 if constexpr (std::is_enum_v<Field>) {
                   const std::string& choice = settings.choice(name);
                   for (std::size_t i = 0; i < legal.size(); ++i) {
                     if (legal[i] == choice) field = static_cast<Field>(i);
                   }
                 } else if constexpr (std::is_same_v<Field, int>) {
                   field = settings.whole(name);
                 } else if constexpr (std::is_same_v<Field, double>) {
                   field = settings.number(name);
                 } else if (settings.find(name)->is_set) {
                   field = settings.number(name);
                 }
               });
  return config;
}

/// Throws std::invalid_argument as Settings::set does for the first number outside its range, or
/// not finite.
template <typename Config>
void check_ranges(const Config& config) {
  Settings settings = settings_of(config);
  const Settings values = settings;
  for (const Setting& setting : values.all()) {
    if (setting.is_set) settings.set(setting.name, setting.value);
  }
}

/// Returns the config. Throws std::invalid_argument as its `check` does.
template <typename Config>
const Config& checked(const Config& config) {
  check(config);
  return config;
}

}  // namespace mosbench
