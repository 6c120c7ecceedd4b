#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/hmm_mos/config.hpp"

namespace mosbench {

/// Sets the keys of the JSON object in `file` over those of `config`. Throws UsageError that names
/// file and key for an unreadable file, malformed JSON, an unknown or repeated key (with the
/// nearest known one), a value of the wrong type or outside its range.
void apply_config_file(const std::filesystem::path& file, Config& config);

/// The same for the text of such a file; `origin` begins every message.
void apply_config_text(std::string_view text, std::string_view origin, Config& config);

/// The same for one "key=value" of the command line.
void apply_config_assignment(std::string_view assignment, Config& config);

/// The effective configuration, keys in the order of `visit_fields`; occupancy_sigma_m is always a
/// number, distance_field_scans appears only when it is not the default, dynamic_window_scans only
/// for the variant that has such a window.
nlohmann::ordered_json to_json(const Config& config, Variant variant);

}  // namespace mosbench
