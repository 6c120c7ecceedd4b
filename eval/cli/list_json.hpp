#pragma once

#include <mosbench/method.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace mosbench {

/// Returns the unit with which the name of a setting ends; empty for numbers without one.
std::string unit_of(const Setting& setting);

/// Returns what `list WHAT` knows, a key per kind: "datasets", "methods", "presets", "protocols",
/// "scenes", "formats"; all of them for "all".
nlohmann::ordered_json list_json(std::string_view what);

/// Returns one method with its settings.
nlohmann::ordered_json method_json(const MethodKind& method);

}  // namespace mosbench
