#pragma once

#include <CLI/App.hpp>
#include <string>
#include <string_view>

namespace mosbench {

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

}  // namespace mosbench
