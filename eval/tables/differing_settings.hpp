#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/results/result_set.hpp"

namespace mosbench {

/// One setting in which runs differ.
struct DifferingSetting {
  std::string name;                            ///< "voxel_size_m"
  std::vector<nlohmann::ordered_json> values;  ///< one per run; null where it has no such setting
};

/// Returns what --perturb said of the scans; empty where they were read as they are.
std::string disturbance_of(const SequenceResult& result);

/// Returns the settings of which two runs by one method have different values, or all runs have one
/// and they differ, as recorded in result.json: those of the method (what `score --method` said
/// for other programs), where the poses are from, and the settings of odometry.
std::vector<DifferingSetting> differing_settings(const std::vector<const ResultSet*>& runs);

}  // namespace mosbench
