#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "datasets/layouts/dataset.hpp"

namespace mosbench {

/// {"scene", "seed", "notice"} of a sequence that `mosbench simulate` wrote, also where a link
/// leads to it; nothing for real data.
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset,
                                                            const Sequence& sequence);
/// The same of the first such sequence of a data set.
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset);

/// The line with which every answer about simulated data begins; empty for real data.
std::string simulated_remark(const Dataset& dataset);

}  // namespace mosbench
