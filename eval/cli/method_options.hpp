#pragma once

#include <CLI/CLI.hpp>

#include "eval/runs/run_plan.hpp"

namespace mosbench {

/// The arguments that say what is segmented and how: DATA, --dataset, --sequences, --method,
/// --preset,
/// --variant, --config, --set, --threads and the flags of `add_reading_flags`.
void add_method_options(CLI::App& command, RunOptions& options);

}  // namespace mosbench
