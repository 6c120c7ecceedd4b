#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "eval/statistics/gate.hpp"

namespace mosbench {

/// Formats a row per check. The paired interval is shown under every rule: it says whether other
/// scans like these would show the difference.
std::string gate_text(const GateResult& result);

/// Formats the verdict, the same table and notes in markdown, for the summary of a pull request;
/// `unlike` says in what else the runs differ.
std::string gate_markdown(const GateResult& result, std::string_view unlike = "");

/// Returns a workflow command of GitHub (`::error ...`) per check that failed; empty when all
/// passed.
std::string gate_annotations(const GateResult& result);

nlohmann::ordered_json to_json(const GateResult& result);

}  // namespace mosbench
