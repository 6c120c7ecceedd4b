#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/engine/run_execute.hpp"

namespace mosbench {

/// What `mosbench run` answers: how it was run, the table, the remarks on each sequence.
Sheet run_sheet(const RunPlan& plan, const std::vector<SequenceOutcome>& outcomes);

/// The same as one JSON object.
nlohmann::ordered_json run_report_json(const RunPlan& plan,
                                       const std::vector<SequenceOutcome>& outcomes);

}  // namespace mosbench
