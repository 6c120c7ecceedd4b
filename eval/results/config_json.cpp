#include "eval/results/config_json.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "datasets/files/errors.hpp"
#include "datasets/files/nearest_name.hpp"

namespace mosbench {
namespace {

using nlohmann::json;

std::vector<std::string_view> config_keys() {
  std::vector<std::string_view> keys;
  const Config config;
  visit_fields(config, [&](std::string_view key, const auto&, FieldRange) { keys.push_back(key); });
  return keys;
}

template <typename Field>
void assign(Field& field, const json& value, FieldRange range, const std::string& where) {
  constexpr bool kWhole = std::is_same_v<Field, int>;
  if (kWhole ? !value.is_number_integer() : !value.is_number()) {
    throw UsageError(fmt::format("{}: {} is not a {}number, expected {} to {}", where,
                                 value.dump(-1, ' ', false, json::error_handler_t::replace),
                                 kWhole ? "whole " : "", range.lowest, range.highest));
  }
  const auto number = value.get<double>();
  // Before the conversion to int, which is undefined for what does not fit. NaN fails as well.
  if (!(number >= range.lowest && number <= range.highest)) {
    throw UsageError(fmt::format("{}: {} is out of range, expected {} to {}", where, value.dump(),
                                 range.lowest, range.highest));
  }
  if constexpr (kWhole) {
    field = value.get<int>();
  } else {
    field = number;
  }
}

void apply_value(std::string_view key, const json& value, std::string_view origin, Config& config) {
  bool known = false;
  visit_fields(config, [&](std::string_view name, auto& field, FieldRange range) {
    if (name != key) return;
    known = true;
    assign(field, value, range, fmt::format("{}: {}", origin, key));
  });
  if (!known) {
    const std::vector<std::string_view> keys = config_keys();
    throw UsageError(fmt::format("{}: key '{}' is not known, expected one of {} (nearest: {})",
                                 origin, key, fmt::join(keys, ", "), nearest_name(key, keys)));
  }
}

json parse_without_repeated_keys(std::string_view text, std::string_view origin) {
  std::set<std::string> seen;
  const auto refuse_repeated = [&](int depth, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::key && depth == 1 &&
        !seen.insert(parsed.get<std::string>()).second) {
      throw UsageError(fmt::format("{}: key {} appears twice, expected once", origin,
                                   parsed.dump(-1, ' ', false, json::error_handler_t::replace)));
    }
    return true;
  };
  try {
    return json::parse(text, refuse_repeated);
  } catch (const json::exception& error) {
    throw UsageError(fmt::format("{}: {}, expected a JSON object", origin, error.what()));
  }
}

}  // namespace

void apply_config_text(std::string_view text, std::string_view origin, Config& config) {
  const json object = parse_without_repeated_keys(text, origin);
  if (!object.is_object()) {
    throw UsageError(fmt::format("{}: holds a {}, expected a JSON object with configuration keys",
                                 origin, object.type_name()));
  }
  for (const auto& [key, value] : object.items()) apply_value(key, value, origin, config);
}

void apply_config_file(const std::filesystem::path& file, Config& config) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream || std::filesystem::is_directory(file)) {
    throw UsageError(file.string() + ": cannot be read, expected a JSON object");
  }
  apply_config_text(text, file.string(), config);
}

void apply_config_assignment(std::string_view assignment, Config& config) {
  const std::string origin = fmt::format("--set {}", assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw UsageError(origin + ": has no key and value, expected key=value");
  }
  const std::string_view value = assignment.substr(equals + 1);
  json parsed = json::parse(value, nullptr, false);
  if (parsed.is_discarded()) parsed = std::string(value);
  apply_value(assignment.substr(0, equals), parsed, origin, config);
}

nlohmann::ordered_json to_json(const Config& config, Variant variant) {
  Config effective = config;
  effective.occupancy_sigma_m = config.sigma_m();
  nlohmann::ordered_json object;
  visit_fields(effective, [&](std::string_view key, const auto& field, FieldRange) {
    if constexpr (std::is_same_v<std::decay_t<decltype(field)>, std::optional<double>>) {
      object[std::string(key)] = *field;
    } else {
      object[std::string(key)] = field;
    }
  });
  if (config.distance_field_scans == Config{}.distance_field_scans) {
    object.erase("distance_field_scans");
  }
  if (variant == Variant::kRelease2025) object.erase("dynamic_window_scans");
  return object;
}

}  // namespace mosbench
