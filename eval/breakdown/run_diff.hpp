#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/answer/answer.hpp"
#include "eval/breakdown/breakdown.hpp"
#include "eval/statistics/run_statistics.hpp"

namespace mosbench {

/// A moving object of which two runs find different numbers of points.
struct ObjectDisagreement {
  std::string sequence, first_scan, last_scan;
  std::size_t points = 0, first_found = 0, second_found = 0;
  double mean_range_m = 0.0;
  Eigen::Vector3d position_map_m = Eigen::Vector3d::Zero();  ///< in its first scan
};

/// Returns the objects of which different numbers of points are found, most changed first. Throws
/// std::invalid_argument unless both break down the same truth.
std::vector<ObjectDisagreement> disagreeing_objects(const SequenceBreakdown& first,
                                                    const SequenceBreakdown& second);

/// Describe the worst `at_most` of each; `objects` is empty when the points are not available.
nlohmann::ordered_json diff_json(const PairedRuns& paired,
                                 const std::vector<ObjectDisagreement>& objects,
                                 std::size_t at_most);
/// `first` and `second` are where the runs lie, which names them.
std::vector<Sheet> diff_sheets(const std::filesystem::path& first,
                               const std::filesystem::path& second, const PairedRuns& paired,
                               const std::vector<ObjectDisagreement>& objects, std::size_t at_most);

}  // namespace mosbench
