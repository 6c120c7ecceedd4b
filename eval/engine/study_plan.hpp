#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/job/study_cells.hpp"
#include "eval/result/result.hpp"

namespace mosbench {

/// What lies where a cell's result belongs.
enum class CellState : std::uint8_t {
  kMissing,
  kFailed,        ///< and what it said lies there
  kOtherVersion,  ///< a result of another version of mosbench
  kDone
};

/// Returns "missing", "failed", "other version" or "done".
std::string_view to_string(CellState state);

/// A scan with a poor IoU.
struct BadScan {
  std::string stem;
  double iou = 0;
  std::int64_t wrong = 0;  ///< points
};

/// What tables need of the result of a cell.
struct CellNumbers {
  std::string version;  ///< of mosbench
  bool simulated = false;
  std::string simulation, fingerprint;  ///< of the sequence, without poses; see `drive_of`
  std::vector<std::string> doubts{};
  SequenceCounts counts;  ///< of the scans that count
  ScanGaps gaps;          ///< between them
  std::array<std::optional<double>, kBriefMetrics.size()> metrics;
  std::optional<double> ms_per_scan, wall_s, core_s;
  std::optional<BadScan> worst;
};

/// Returns what tables need of a result.
CellNumbers numbers_of(const Result& result);

struct PlannedCell {
  StudyCell cell;
  CellState state = CellState::kMissing;
  CellNumbers numbers = {};  ///< of a result that lies there
  std::string failure = {};  ///< why there is none
};

/// All cells of a study, in the order of its file.
struct StudyPlan {
  const Study* study = nullptr;
  std::filesystem::path out;
  std::vector<PlannedCell> cells;
  /// By which every cell is scored; nothing where the settings of all are refused.
  std::optional<ScoreRule> rule;
};

/// Returns "default of preset semantickitti": where the settings that no axis changes come from.
std::string default_title(const StudyPlan& plan);

/// Lists the cells and what is known of them. Data on disk are opened, simulated ones are not made.
/// With `only` given, of these keys alone. Throws UsageError, also where cells would be scored by
/// different rules, and DataError; a sequence that cannot be opened is a cell that will fail.
/// `known` as of `files_of_program`.
StudyPlan plan_study(const Study& study, const std::filesystem::path& out,
                     const std::vector<std::string>& only = {},
                     const std::vector<ProgramFile>* known = nullptr);

/// Returns the files that commands of programs named when the results there were made.
std::vector<ProgramFile> recorded_program_files(const Study& study,
                                                const std::filesystem::path& out);

/// Looks again at what lies there for the cells as they were planned, also where a program has
/// changed a file of its command since, by which they would have other keys now: tells of that.
void refresh(StudyPlan& plan);

/// Returns the folder of a cell: its result.json, or its failure.json.
std::filesystem::path cell_folder(const std::filesystem::path& out, const std::string& key);

/// Returns where data lie; simulated ones below the folder of the study.
std::filesystem::path place_of(const std::filesystem::path& out, const Data& data);

/// Removes what processes of this host that have ended left half-written in a study's folder.
void clear_study(const std::filesystem::path& out);

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
