#pragma once

#include <string>

#include "eval/answer/answer.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/job.hpp"
#include "eval/tables/published.hpp"

namespace mosbench {

/// Returns a table of the paper by its name or that of its data set. Throws UsageError.
const PaperTable& table_to_run(const std::string& name);

/// Runs all that a table of the paper needs of the data in `words`, keeps what is finished, and
/// returns the table.
Answer run_table(const PaperTable& table, const DataWords& words, const RunPlace& place);

}  // namespace mosbench
