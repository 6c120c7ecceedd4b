#pragma once

#include <mosbench/method.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace mosbench {

/// Returns the unit with which the name of a setting ends; empty for numbers without one.
std::string unit_of(const Setting& setting);

/// What `list` knows of a kind, an object per row.
nlohmann::ordered_json datasets_json();
nlohmann::ordered_json methods_json();
nlohmann::ordered_json odometry_json();
nlohmann::ordered_json presets_json();
nlohmann::ordered_json protocols_json();
nlohmann::ordered_json scenes_json();
nlohmann::ordered_json formats_json();
nlohmann::ordered_json perturbations_json();

/// Returns one method with its settings.
nlohmann::ordered_json method_json(const MethodKind& method);

}  // namespace mosbench
