#pragma once

#include <string>

namespace CLI {
class App;
}

namespace mosbench {

/// Returns what completes the words of the program in "bash" or "zsh"; for "commands" a table of
/// them.
std::string completion_of(const CLI::App& program, const std::string& shell);

}  // namespace mosbench
