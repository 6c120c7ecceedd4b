#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "eval/answer/answer.hpp"

namespace CLI {
class App;
}

namespace mosbench {

/// Runs a command with the flags that were parsed. Throws UsageError and DataError.
using CommandRun = std::function<Answer()>;

/// One command of the program.
struct Command {
  std::string_view name;
  std::string_view help;  ///< one line
  /// Adds the command's flags to its parser and returns what runs it after the parsing.
  CommandRun (*add)(CLI::App& command);
  bool draws = false;  ///< its answers have charts
};

/// How the program ends after an error, and what it says.
struct Failure {
  int exit_code;
  std::string message;
};

/// Returns that of the exception that is being handled.
Failure current_failure();

/// All commands, in the order in which --help shows them.
std::span<const Command> commands();

CommandRun add_compare(CLI::App& command);
CommandRun add_convert(CLI::App& command);
CommandRun add_doctor(CLI::App& command);
CommandRun add_help(CLI::App& command);
CommandRun add_list(CLI::App& command);
CommandRun add_odometry(CLI::App& command);
CommandRun add_profile(CLI::App& command);
CommandRun add_rank(CLI::App& command);
CommandRun add_render(CLI::App& command);
CommandRun add_report(CLI::App& command);
CommandRun add_run(CLI::App& command);
CommandRun add_score(CLI::App& command);
CommandRun add_simulate(CLI::App& command);
CommandRun add_stats(CLI::App& command);
CommandRun add_table(CLI::App& command);
CommandRun add_trajectory(CLI::App& command);

}  // namespace mosbench
