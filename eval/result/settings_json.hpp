#pragma once

#include <filesystem>
#include <mosbench/settings.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace mosbench {

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
