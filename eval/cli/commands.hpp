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
  std::string_view own_format = "";  ///< that only its answers have: png or junit
};

/// How the program ends after an error, and what it says.
struct Failure {
  int exit_code;
  std::string message;
};

/// Returns that of the exception that is being handled.
Failure current_failure();

/// Writes that nothing was judged to the files which a line of `compare` names, as far as it is
/// understood: what they hold of the line before must not be taken for the answer to this one.
void keep_failure_of_compare(std::vector<std::string> arguments, const Failure& failure);

/// All commands, in the order in which --help shows them.
std::span<const Command> commands();

/// Returns docs/help/<name>.txt as it was when the program was built: what --help shows of a
/// command behind its flags and, below a line "---", what only --help-all shows.
std::string_view help_page(std::string_view name);

/// Returns "mosbench", or "mosbench run" of the command run.
std::string full_name(const CLI::App& command);

/// Returns --help of a command or of the program, or --help-all: texts of options are wrapped at
/// 100 columns and have their defaults behind them.
std::string help_of(const CLI::App& command, bool all = false);

/// Throws UsageError naming the nearest command when there is none of this name.
void check_command_name(const std::string& name);

CommandRun add_compare(CLI::App& command);
CommandRun add_convert(CLI::App& command);
CommandRun add_doctor(CLI::App& command);
CommandRun add_help(CLI::App& command);
CommandRun add_info(CLI::App& command);
CommandRun add_list(CLI::App& command);
CommandRun add_map(CLI::App& command);
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
CommandRun add_truth(CLI::App& command);

}  // namespace mosbench
