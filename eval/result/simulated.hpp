#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "datasets/layouts/dataset.hpp"
#include "datasets/layouts/simulated_origin.hpp"
#include "eval/answer/answer.hpp"

namespace mosbench {

/// "simulated data (scene mall, seed 1): not comparable with published numbers".
std::string simulated_notice(const SimulatedOrigin& origin);

/// What made a sequence that `mosbench simulate` wrote, also where a link leads to it; nothing for
/// real data.
std::optional<SimulatedOrigin> origin_of(const Dataset& dataset, const Sequence& sequence);
/// The same of the first such sequence of a data set.
std::optional<SimulatedOrigin> origin_of(const Dataset& dataset);
std::optional<nlohmann::ordered_json> simulated_origin_json(const Dataset& dataset);

/// What every format has to show beside numbers of a data set.
Standing standing_of(const Dataset& dataset);

}  // namespace mosbench
