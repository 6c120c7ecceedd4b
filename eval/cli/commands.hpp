#pragma once

#include <CLI/App.hpp>
#include <stdexcept>
#include <string>

namespace mosbench {

/// A comparison or check that came out bad: `what()` belongs on stdout, and the program ends with
/// `exit_code`.
class Finding : public std::runtime_error {
 public:
  explicit Finding(const std::string& answer, int code = 1)
      : std::runtime_error(answer), exit_code(code) {}
  int exit_code;
};

/// Each adds one sub-command to `app`. When it is the chosen one, parsing runs it and leaves what
/// belongs on stdout in `answer`. Errors are thrown: UsageError, DataError.
void add_convert_command(CLI::App& app, std::string& answer);
void add_simulate_command(CLI::App& app, std::string& answer);
void add_run_command(CLI::App& app, std::string& answer);
void add_profile_command(CLI::App& app, std::string& answer);
void add_score_command(CLI::App& app, std::string& answer);
void add_report_command(CLI::App& app, std::string& answer);
void add_render_command(CLI::App& app, std::string& answer);
void add_bless_command(CLI::App& app, std::string& answer);
void add_compare_command(CLI::App& app, std::string& answer);
void add_table_command(CLI::App& app, std::string& answer);
void add_reproduce_command(CLI::App& app, std::string& answer);
void add_breakdown_command(CLI::App& app, std::string& answer);
void add_diff_command(CLI::App& app, std::string& answer);
void add_stats_command(CLI::App& app, std::string& answer);
void add_odometry_command(CLI::App& app, std::string& answer);
void add_trajectory_command(CLI::App& app, std::string& answer);
void add_doctor_command(CLI::App& app, std::string& answer);
void add_list_command(CLI::App& app, std::string& answer);

}  // namespace mosbench
