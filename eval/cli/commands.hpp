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
  std::string_view alias{};  ///< another name that it answers to; empty: none
  bool draws = false;        ///< its answers have charts

  /// Returns all names that it answers to, its own first.
  std::vector<std::string_view> names() const;
};

/// All commands, in the order in which --help shows them.
std::span<const Command> commands();

CommandRun add_bless(CLI::App& command);
CommandRun add_breakdown(CLI::App& command);
CommandRun add_compare(CLI::App& command);
CommandRun add_completion(CLI::App& command);
CommandRun add_convert(CLI::App& command);
CommandRun add_curve(CLI::App& command);
CommandRun add_diff(CLI::App& command);
CommandRun add_doctor(CLI::App& command);
CommandRun add_help(CLI::App& command);
CommandRun add_list(CLI::App& command);
CommandRun add_map_score(CLI::App& command);
CommandRun add_odometry(CLI::App& command);
CommandRun add_profile(CLI::App& command);
CommandRun add_rank(CLI::App& command);
CommandRun add_render(CLI::App& command);
CommandRun add_report(CLI::App& command);
CommandRun add_reproduce(CLI::App& command);
CommandRun add_run(CLI::App& command);
CommandRun add_score(CLI::App& command);
CommandRun add_simulate(CLI::App& command);
CommandRun add_stats(CLI::App& command);
CommandRun add_study(CLI::App& command);
CommandRun add_table(CLI::App& command);
CommandRun add_trajectory(CLI::App& command);

}  // namespace mosbench
