#pragma once

#include <span>
#include <string>

#include "eval/cli/commands.hpp"
#include "eval/engine/run_plan.hpp"
#include "eval/job/job_words.hpp"

namespace mosbench {

/// Runs the methods of a list, sequence by sequence one after the other, and writes products of
/// each (see `write_products`). Throws UsageError and DataError for what is wrong before the first
/// scan; a method that fails later is named in the answer, whose exit code is that of the first
/// failure.
Answer run_methods(const JobWords& words, const RunPlace& place,
                   std::span<const std::string> products);

}  // namespace mosbench
