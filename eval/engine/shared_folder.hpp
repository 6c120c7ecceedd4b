#pragma once

#include "eval/engine/run_plan.hpp"

namespace mosbench {

/// Throws UsageError naming what lies there when the plan's folder holds results that are not of
/// the plan's sequences and come from another data set, method or setting: together they would be
/// no run that `stats`, `compare` or `table` could read. `rules` are the members of result.json
/// that all sequences of a run share.
void check_shared_folder(const RunPlan& plan, const nlohmann::ordered_json& rules);

}  // namespace mosbench
