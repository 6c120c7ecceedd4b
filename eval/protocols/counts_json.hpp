#pragma once

#include <nlohmann/json.hpp>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// {"tp", "fp", "fn", "tn", "ignored"}, as every JSON of the program names counts of points.
nlohmann::ordered_json counts_json(const Confusion& counts);

}  // namespace mosbench
