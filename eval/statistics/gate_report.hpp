#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/statistics/gate.hpp"

namespace mosbench {

/// Says the verdict and a row per check. The paired interval is shown under every rule: it says
/// whether other scans like these would show the difference.
Sheet gate_sheet(const GateResult& result);

/// Returns one per check that failed.
std::vector<Annotation> gate_annotations(const GateResult& result);

nlohmann::ordered_json to_json(const GateResult& result);

}  // namespace mosbench
