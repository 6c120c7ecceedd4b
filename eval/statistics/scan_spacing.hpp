#pragma once

#include "eval/result/result_set.hpp"
#include "eval/statistics/uncertainty.hpp"

namespace mosbench {

/// Returns how far the counted scans are apart, by their names where these are numbers or stamps.
Spacing spacing_of(const Result& result);
Spacing spacing_of(const ResultSet& set);

}  // namespace mosbench
