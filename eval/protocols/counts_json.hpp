#pragma once

#include <nlohmann/json.hpp>

#include "eval/protocols/confusion.hpp"

namespace mosbench {

/// Returns {"tp", "fp", "fn", "tn", "ignored"}, the names that every JSON of the program uses.
nlohmann::ordered_json counts_json(const Confusion& counts);

}  // namespace mosbench
