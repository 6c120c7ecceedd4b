#pragma once

#include <CLI/CLI.hpp>

#include "eval/job/job_words.hpp"

namespace mosbench {

/// Adds the arguments that say what is segmented and how: those of `add_dataset_flags`, --method,
/// --preset, --set and --threads.
void add_method_options(CLI::App& command, JobWords& words, unsigned& threads);

}  // namespace mosbench
