#pragma once

#include <CLI/App.hpp>
#include <string>

namespace mosbench {

/// Returns the script that completes commands, flags and their values in bash or zsh; for
/// "commands" the name and the one-line help of every command, separated by a tab.
std::string completion_of(const CLI::App& program, const std::string& shell);

}  // namespace mosbench
