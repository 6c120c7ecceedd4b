#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "eval/engine/study_plan.hpp"

namespace mosbench {

/// What is to be computed, and what it is expected to take.
struct StudyWork {
  std::vector<const PlannedCell*> cells;  ///< that are not done
  std::optional<double> cpu_s;            ///< of one core; nothing where a cost is not known
};
StudyWork work_of(const StudyPlan& plan, const CostModel& costs);

/// Computes what is missing in this process, a cell after the other with so many threads. Throws
/// DataError where the folder cannot be written.
void run_here(const StudyPlan& plan, unsigned threads);

struct EngineOptions {
  std::string profile = "local";  ///< local, slurm, or the folder of a profile of the user's
  unsigned threads = 1;           ///< of each cell
  std::filesystem::path program;  ///< mosbench
};

/// Computes what is missing by Snakemake: short cells of the same data are grouped into one job.
/// Simulated data are made first. A signal that ends this process ends all that it started. Returns
/// Snakemake's exit code. Throws DataError where Snakemake
/// is not installed or the folder cannot be written.
int run_engine(const StudyPlan& plan, const CostModel& costs, const EngineOptions& options);

}  // namespace mosbench
