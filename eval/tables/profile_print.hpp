#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/engine/sequence_runner.hpp"

namespace mosbench {

/// The numbers and those of each scan; `stages` in milliseconds per scan.
nlohmann::ordered_json profile_json(const RunPlan& plan,
                                    const std::vector<SequenceProfile>& profiles);

/// The costs by stage and the memory of each sequence.
Answer profile_answer(const RunPlan& plan, const std::vector<SequenceProfile>& profiles);

/// Chrome's trace event format, for Perfetto or chrome://tracing: a slice for each stage of each
/// scan, counters for resident memory and map blocks.
nlohmann::ordered_json profile_trace(const std::vector<SequenceProfile>& profiles);

}  // namespace mosbench
