#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/result/result_set.hpp"

namespace mosbench {

/// One setting in which runs differ.
struct DifferingSetting {
  std::string name;                                 ///< "voxel_size_m"
  std::vector<std::optional<SettingValue>> values;  ///< one per run; none where it has no such one
};

/// Returns the settings of which two runs by one method have different values, or all runs have one
/// and they differ, as recorded in result.json: those of the method (what `score --method` said
/// for other programs), where the poses are from, and the settings of odometry.
std::vector<DifferingSetting> differing_settings(const std::vector<const ResultSet*>& runs);

}  // namespace mosbench
