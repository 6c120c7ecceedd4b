#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace mosbench {

/// Version of the members of what commands print as JSON; result.json counts its own as "format".
inline constexpr int kSchemaVersion = 2;

/// JSON as the program prints and writes it: indented by one blank, ended by a line feed, with
/// "schema_version" first and control characters escaped. Bytes that are no UTF-8, as file names
/// may hold, are replaced.
std::string json_text(const nlohmann::ordered_json& json);

/// null where there is no value.
template <typename Value>
nlohmann::ordered_json json_or_null(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// "62.3" of 0.6229, "undefined" of nothing; `style` is that of fmt. Metrics have one digit
/// wherever they are printed, differences two.
std::string percent_text(const std::optional<double>& fraction, const char* style = "{:.1f}");

/// "(1.0, -2.5, 0.3)", metres.
std::string position_text(const Eigen::Vector3d& position_m);

}  // namespace mosbench
