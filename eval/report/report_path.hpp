#pragma once

#include <nlohmann/json.hpp>

#include "eval/result/result_scans.hpp"

namespace mosbench {

/// The way of the sensor from above, in metres: `run_m`, [x, y] per scan of the poses of the run.
/// If the data set has other poses for the same scans: also `own_m`, the length `way_m` of that
/// path up to each scan, and the distance `off_m` of the run's positions to its; the run's first
/// pose is then moved onto the data set's.
nlohmann::ordered_json path_of(const Result& result, const ResultScans& scans);

}  // namespace mosbench
