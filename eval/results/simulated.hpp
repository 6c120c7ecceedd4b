#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// {"scene", "seed", "notice"} of a data set that `mosbench simulate` wrote; nothing for real data.
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset);

/// The line with which every answer about simulated data begins; empty for real data.
std::string simulated_remark(const Dataset& dataset);

}  // namespace mosbench
