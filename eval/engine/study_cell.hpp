#pragma once

#include <nlohmann/json.hpp>

#include "eval/engine/study_plan.hpp"

namespace mosbench {

/// What asking for a cell led to.
enum class CellOutcome : std::uint8_t { kComputed, kKept, kFailed };

/// Computes a cell, unless it is done, as `mosbench run` computes a sequence, but keeps no labels.
/// What is wrong with its data or settings is written to its folder, and told. Throws DataError
/// when that cannot be written.
CellOutcome compute_cell(const PlannedCell& planned, const std::filesystem::path& out,
                         unsigned threads);

/// Returns where data lie, and makes simulated ones first where they are missing, in one step for
/// all who look, also on other hosts. Throws as `simulate` does.
std::filesystem::path made_data(const std::filesystem::path& out, const Data& data);

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
