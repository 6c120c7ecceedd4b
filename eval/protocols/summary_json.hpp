#pragma once

#include <nlohmann/json.hpp>

#include "eval/protocols/metrics.hpp"

namespace mosbench {

/// Fractions 0..1, null where undefined; counts are those of all scans together.
nlohmann::ordered_json to_json(const Summary& summary);

}  // namespace mosbench
