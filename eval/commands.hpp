#pragma once

#include <CLI/App.hpp>
#include <string>

namespace mosbench {

/// Each adds one sub-command to `app`. When it is the chosen one, parsing runs it and leaves what
/// belongs on stdout in `answer`. Errors are thrown: UsageError, DataError.
void add_simulate_command(CLI::App& app, std::string& answer);
void add_run_command(CLI::App& app, std::string& answer);
void add_profile_command(CLI::App& app, std::string& answer);
void add_score_command(CLI::App& app, std::string& answer);
void add_report_command(CLI::App& app, std::string& answer);
void add_render_command(CLI::App& app, std::string& answer);
void add_list_command(CLI::App& app, std::string& answer);

}  // namespace mosbench
