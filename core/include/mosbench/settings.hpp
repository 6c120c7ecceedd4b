#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace mosbench {

/// Value of a setting: a whole number, a number, or a text, mostly one of a list of names.
using SettingValue = std::variant<int, double, std::string>;

/// One parameter of a method. Its unit is the end of its name (`_m`, `_scans`, ...).
struct Setting {
  std::string_view name;                  ///< as in --set and result.json
  SettingValue value;                     ///< its alternative is the type of the setting
  std::string_view meaning;               ///< one line, with the paper's symbol
  double lowest = 0;                      ///< legal; unused for names
  double highest = 0;                     ///< legal; unused for names
  std::vector<std::string_view> choices;  ///< of a text; empty: any text
  std::string_view follows;  ///< the setting whose value is taken while this one is not set
  bool is_set = true;        ///< false: the value is that of `follows`
};

/// The parameters of a method with their values, in the order in which they are shown.
class Settings {
 public:
  Settings() = default;
  /// Takes the settings of a method with their defaults.
  explicit Settings(std::vector<Setting> settings);

  /// Returns all settings in their order.
  std::span<const Setting> all() const { return settings_; }
  /// Returns nullptr when there is no setting of this name.
  const Setting* find(std::string_view name) const;

  /// Returns the effective value of a number, whole or not. Throws std::invalid_argument for an
  /// unknown name or another type.
  double number(std::string_view name) const;
  /// Does the same for a whole number.
  int whole(std::string_view name) const;
  /// Does the same for a text.
  const std::string& choice(std::string_view name) const;

  /// Throws std::invalid_argument "<name>: <what is wrong>, <what was expected>" for an unknown
  /// name, a value of another type or outside its range or choices. A whole number is taken where
  /// a number is expected.
  void set(std::string_view name, const SettingValue& value);

 private:
  Setting& at(std::string_view name);

  std::vector<Setting> settings_;
};

/// Settings that play the same part in every method that has them. Tables print them first.
namespace common_settings {
inline constexpr std::string_view kVariant = "variant";           ///< of the authors' program
inline constexpr std::string_view kVoxelSize_m = "voxel_size_m";  ///< edge of a voxel of the map
inline constexpr std::string_view kMinRange_m = "min_range_m";    ///< nearer points never move
inline constexpr std::string_view kMaxRange_m = "max_range_m";    ///< farther points never move
inline constexpr std::string_view kDelay_scans = "delay_scans";   ///< labels come so much later
inline constexpr std::string_view kTrackWindow_s = "track_window_s";  ///< whole tracks are judged
}  // namespace common_settings

/// Returns "0.1 to 1000", or "paper-2024 or release-2025".
std::string legal_values(const Setting& setting);

/// "0.2" or "paper-2024".
std::string to_string(const SettingValue& value);

}  // namespace mosbench
