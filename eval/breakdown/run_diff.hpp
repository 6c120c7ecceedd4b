#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/breakdown/breakdown.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {

/// A scan in which two runs count differently.
struct ScanDisagreement {
  PairedRuns::Scan scan;
  std::uint64_t changed_points = 0;  ///< at least so many points changed: of tp plus of fp
};

/// A moving object of which two runs find different parts.
struct ObjectDisagreement {
  std::string sequence, first_scan, last_scan;
  std::size_t points = 0, first_found = 0, second_found = 0;
  double mean_range_m = 0.0;
  Eigen::Vector3d position_map_m = Eigen::Vector3d::Zero();  ///< in its first scan
};

/// What two runs are called where both are shown.
struct RunNames {
  std::string first, second;
};

/// The last names of their folders, or the whole paths where those are equal.
RunNames names_apart(const std::filesystem::path& first, const std::filesystem::path& second);

/// The scans with other counts, most changed first.
std::vector<ScanDisagreement> disagreeing_scans(const PairedRuns& paired);

/// The objects found to different parts, most changed first. Both break down the same truth; throws
/// std::invalid_argument otherwise.
std::vector<ObjectDisagreement> disagreeing_objects(const SequenceBreakdown& first,
                                                    const SequenceBreakdown& second);

/// Everything about the worst `at_most` of each; `objects` is empty without points at hand.
nlohmann::ordered_json diff_json(const PairedRuns& paired,
                                 const std::vector<ObjectDisagreement>& objects,
                                 std::size_t at_most);
std::string diff_text(const RunNames& names, const PairedRuns& paired,
                      const std::vector<ObjectDisagreement>& objects, std::size_t at_most);

}  // namespace mosbench
