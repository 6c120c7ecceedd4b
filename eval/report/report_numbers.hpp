#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "eval/report/result_scans.hpp"

namespace mosbench {

/// Metrics of a result with their intervals, as `mosbench stats` gives them; null without truth.
nlohmann::ordered_json estimates_of(const FoundResult& result);

/// Where the labels are right and wrong, as `mosbench breakdown` tells it; null without truth.
nlohmann::ordered_json breakdown_of(const ResultScans& scans);

/// The labels by the rules of every protocol, as `mosbench score --protocol all` puts them side by
/// side; null without truth.
nlohmann::ordered_json protocols_of(const ResultScans& scans);

/// The published tables that have a cell measured by the results below `inputs`; simulated ones
/// fill none.
nlohmann::ordered_json covered_tables(const std::vector<std::filesystem::path>& inputs);

}  // namespace mosbench
