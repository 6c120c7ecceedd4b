#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "eval/result/result_scans.hpp"

namespace mosbench {

/// Returns the metrics of a result with intervals, as `mosbench stats` does; null without truth.
nlohmann::ordered_json estimates_of(const Result& result);

/// Returns the breakdown of a result, as `mosbench breakdown` does; null without truth.
nlohmann::ordered_json breakdown_of(const ResultScans& scans);

/// Returns the summary of a result under every protocol, as `mosbench score --protocol all` does;
/// null without truth.
nlohmann::ordered_json protocols_of(const ResultScans& scans);

/// Returns the published tables with at least one cell measured by the results below `inputs`;
/// results on simulated data are not used.
nlohmann::ordered_json covered_tables(const std::vector<std::filesystem::path>& inputs);

}  // namespace mosbench
