#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <mosbench/settings.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// A record has one list of its fields, from which its names, legal values and meanings follow
/// wherever it is read, written or shown: visit_fields(record, visit), with one call per field:
///
///     visit("voxel_size_m", record.voxel_size_m, FieldRange{0.01, 10.0}, "edge of a voxel");
///     visit("variant", record.variant, kVariantNames, "an enum with its names in order");
///     visit("scores", record.scores, kOffOn, "a bool");
///     visit("label", record.label, AnyText{}, "a text");
///
/// Each may also be an optional. This header turns such records into Settings and back.
namespace mosbench {

/// Closed interval of the legal values of a number. `follows` names the field whose value stands
/// for an optional that is not set.
struct FieldRange {
  double lowest, highest;
  std::string_view follows = {};
};

/// The names of a bool's values.
inline constexpr std::array<std::string_view, 2> kOffOn = {"off", "on"};

/// The legal values of a text: any.
struct AnyText {};

namespace fields {

/// The type of a field, or of what an optional one holds.
template <typename Field>
struct Held {
  using Type = Field;
  static constexpr bool kOptional = false;
};
template <typename Value>
struct Held<std::optional<Value>> {
  using Type = Value;
  static constexpr bool kOptional = true;
};

template <typename Value>
inline constexpr bool kNamed = std::is_enum_v<Value> || std::is_same_v<Value, bool>;

template <typename Value, typename Legal>
SettingValue setting_value(const Value& value, const Legal& legal) {
  if constexpr (kNamed<Value>) {
    return std::string(legal[static_cast<std::size_t>(value)]);
  } else {
    return value;
  }
}

template <typename Value, typename Legal>
Value value_in(const Settings& settings, std::string_view name, const Legal& legal) {
  if constexpr (kNamed<Value>) {
    return static_cast<Value>(std::ranges::find(legal, settings.choice(name)) - legal.begin());
  } else if constexpr (std::is_same_v<Value, int>) {
    return settings.whole(name);
  } else if constexpr (std::is_same_v<Value, double>) {
    return settings.number(name);
  } else {
    return settings.choice(name);
  }
}

inline void note_legal(const FieldRange& range, Setting& setting) {
  setting.lowest = range.lowest;
  setting.highest = range.highest;
  setting.follows = range.follows;
}
inline void note_legal(AnyText, Setting&) {}
template <std::size_t N>
void note_legal(const std::array<std::string_view, N>& names, Setting& setting) {
  setting.choices.assign(names.begin(), names.end());
}

}  // namespace fields

/// Returns the fields of a record with their values.
template <typename Record>
Settings settings_of(const Record& record) {
  std::vector<Setting> settings;
  visit_fields(record, [&](std::string_view name, const auto& field, const auto& legal,
                           std::string_view meaning) {
    using Field = fields::Held<std::decay_t<decltype(field)>>;
    Setting& setting = settings.emplace_back();
    setting.name = name;
    setting.meaning = meaning;
    fields::note_legal(legal, setting);
    if constexpr (Field::kOptional) {
      setting.is_set = field.has_value();
      setting.value = fields::setting_value(field.value_or(typename Field::Type{}), legal);
    } else {
      setting.value = fields::setting_value(field, legal);
    }
  });
  return Settings(std::move(settings));
}

/// Returns the record that `settings`, which `settings_of` made of such a record, describe.
template <typename Record>
Record config_of(const Settings& settings) {
  Record record;
  visit_fields(record,
               [&](std::string_view name, auto& field, const auto& legal, std::string_view) {
                 using Field = fields::Held<std::decay_t<decltype(field)>>;
                 if (Field::kOptional && !settings.find(name)->is_set) return;
                 field = fields::value_in<typename Field::Type>(settings, name, legal);
               });
  return record;
}

/// Throws std::invalid_argument as Settings::set does for the first number outside its range, or
/// not finite.
template <typename Record>
void check_ranges(const Record& record) {
  Settings settings = settings_of(record);
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
