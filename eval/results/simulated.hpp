#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "datasets/layouts/dataset.hpp"
#include "eval/answer/answer.hpp"

namespace mosbench {

/// {"scene", "seed", "notice"} of a sequence that `mosbench simulate` wrote, also where a link
/// leads to it; nothing for real data.
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset,
                                                            const Sequence& sequence);
/// The same of the first such sequence of a data set.
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset);

/// What every format has to show beside numbers of a data set.
Standing standing_of(const Dataset& dataset);

}  // namespace mosbench
