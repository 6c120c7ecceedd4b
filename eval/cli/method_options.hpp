#pragma once

#include <CLI/CLI.hpp>

#include "eval/engine/run_plan.hpp"

namespace mosbench {

/// Adds --set KEY=VALUE,..., after which further KEY=VALUE arguments may follow. To be called
/// before other positional options are added; `assignments` must outlive the parsing.
void add_set_flag(CLI::App& command, std::vector<std::string>& assignments);

/// Adds the arguments that say what is segmented and how: those of `add_dataset_flags`, --method,
/// --preset, --variant, --config, --set and --threads.
void add_method_options(CLI::App& command, RunOptions& options);

}  // namespace mosbench
