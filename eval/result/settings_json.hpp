#pragma once

#include <filesystem>
#include <mosbench/settings.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mosbench {

/// Settings with their effective values in the order of the method, as they were when a result was
/// made: its method may be of another version, or not be known at all.
class RecordedSettings {
 public:
  using Entry = std::pair<std::string, SettingValue>;

  RecordedSettings() = default;
  explicit RecordedSettings(const Settings& settings);

  const std::vector<Entry>& all() const { return entries_; }
  /// Returns null when there is no setting of this name.
  const SettingValue* find(std::string_view name) const;
  /// Returns the value of a number, whole or not, and of a word; else what is given.
  double number(std::string_view name, double otherwise) const;
  std::string word(std::string_view name) const;
  void set(std::string_view name, const SettingValue& value);

  bool operator==(const RecordedSettings& other) const;

 private:
  std::vector<Entry> entries_;
};

/// Whether values are the same; 30 is 30.0.
bool are_equal(const SettingValue& one, const SettingValue& other);
/// Returns "50.0", "2" or "paper-2024", as result.json has it.
std::string value_text(const SettingValue& value);

nlohmann::ordered_json to_json(const SettingValue& value);
nlohmann::ordered_json to_json(const RecordedSettings& settings);
/// Reads what `to_json` wrote. Throws std::invalid_argument naming a setting with a value that none
/// can have, nlohmann's exceptions for what is no object.
RecordedSettings recorded_settings(const nlohmann::ordered_json& json);

/// Throws std::invalid_argument naming the first setting that its method cannot have: a value of
/// the wrong type or outside its range.
void check_recorded_settings(const RecordedSettings& settings, std::string_view method);

/// Returns settings in one line: those that every user asks for, then those that differ from the
/// method's defaults.
std::string describe_settings(const RecordedSettings& settings, std::string_view method);

/// Sets the keys of the JSON object in `file` over those of `settings`, and returns them. Throws
/// UsageError that
/// names file and key for an unreadable file, malformed JSON, an unknown or repeated key (with the
/// nearest known one), a value of the wrong type or outside its range.
std::vector<std::string> apply_settings_file(const std::filesystem::path& file, Settings& settings);

/// The same for the text of such a file; `origin` begins every message.
std::vector<std::string> apply_settings_text(std::string_view text, std::string_view origin,
                                             Settings& settings);

/// The same for one "key=value" of the command line.
void apply_setting_assignment(std::string_view assignment, Settings& settings);

/// Returns every setting with its effective value, in the order of the method.
nlohmann::ordered_json to_json(const Settings& settings);

}  // namespace mosbench
