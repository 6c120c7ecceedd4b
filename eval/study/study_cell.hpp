#pragma once

#include "eval/study/study_plan.hpp"

namespace mosbench {

/// What asking for a cell led to.
enum class CellOutcome : std::uint8_t { kComputed, kKept, kFailed };

/// Computes a cell unless it is done, and writes its record in one step. What is wrong with its
/// data or settings is written where `failure_file` says, and told. Throws DataError when the
/// record cannot be written.
CellOutcome compute_cell(const PlannedCell& planned, const Study& study,
                         const std::filesystem::path& out, unsigned threads);

/// Measures the first scans of every method on every sequence of data that are not measured yet,
/// one thread, and writes what a scan costs to the study's folder. Throws DataError.
void measure_costs(const StudyPlan& plan);

/// What cells are expected to take, from what was measured.
struct CostModel {
  /// Returns seconds of a cell; nothing where its method was not measured on its sequence.
  std::optional<double> seconds(const StudyCell& cell) const;
  /// Returns MiB of a cell; nothing likewise.
  std::optional<double> memory_mib(const StudyCell& cell) const;

  nlohmann::ordered_json costs = nlohmann::ordered_json::object();  ///< by sequence and method
};
CostModel read_costs(const std::filesystem::path& out);

}  // namespace mosbench
