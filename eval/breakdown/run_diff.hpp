#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/statistics/paired_runs.hpp"

namespace mosbench {

/// A scan in which two runs count differently.
struct ScanDisagreement {
  PairedRuns::Scan scan;
  std::uint64_t changed_points = 0;  ///< change of tp plus change of fp: a lower bound
};

/// A moving object of which two runs find different numbers of points.
struct ObjectDisagreement {
  std::string sequence, first_scan, last_scan;
  std::size_t points = 0, first_found = 0, second_found = 0;
  double mean_range_m = 0.0;
  Eigen::Vector3d position_map_m = Eigen::Vector3d::Zero();  ///< in its first scan
};

/// Short names of two runs.
struct RunNames {
  std::string first, second;
};

/// Returns the last components of both paths, or the whole paths where those are equal.
RunNames names_apart(const std::filesystem::path& first, const std::filesystem::path& second);

/// Returns the scans whose counts differ, most changed first.
std::vector<ScanDisagreement> disagreeing_scans(const PairedRuns& paired);

/// Returns the objects of which different numbers of points are found, most changed first. Throws
/// std::invalid_argument unless both break down the same truth.
std::vector<ObjectDisagreement> disagreeing_objects(const SequenceBreakdown& first,
                                                    const SequenceBreakdown& second);

/// Describe the worst `at_most` of each; `objects` is empty when the points are not available.
nlohmann::ordered_json diff_json(const PairedRuns& paired,
                                 const std::vector<ObjectDisagreement>& objects,
                                 std::size_t at_most);
std::vector<Sheet> diff_sheets(const RunNames& names, const PairedRuns& paired,
                               const std::vector<ObjectDisagreement>& objects, std::size_t at_most);

}  // namespace mosbench
