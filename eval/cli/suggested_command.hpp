#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

// Commands that messages tell users to type run as they are printed: in the user's shell and
// folder, with the flags that were given. Each stands in a line of its own, after two blanks.

namespace mosbench {

/// Returns the arguments as a line to type, on a line of its own.
std::string typed_line(const std::vector<std::string>& arguments);

/// Returns those of the arguments and flags that were given to `command` and are wanted, a blank in
/// front of each word.
std::string given_words(const CLI::App& command,
                        const std::function<bool(const CLI::Option&)>& wanted);

/// Returns the commands that get on where the scans of `command` have no poses: the same with
/// odometry, where it has that, else odometry and then the same with its poses. `arguments` are
/// what was typed. Empty for a command that takes no poses.
std::string commands_with_odometry(const CLI::App& command,
                                   const std::vector<std::string>& arguments);

}  // namespace mosbench
