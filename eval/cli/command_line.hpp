#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mosbench {

/// How the program ends after an error: of the call, of what it reads or writes, or its own.
enum ExitCode { kUsage = 2, kUnusable = 3, kInternal = 70 };

/// What the program writes to stdout, and its exit code.
struct Printed {
  std::string bytes;
  int exit_code;
  bool is_text;           ///< for people, who may see it in colours
  std::string failure{};  ///< why nothing was found out; stderr says it, Python raises it
};

/// Parses the arguments that follow the program's name, runs the command they name and formats its
/// answer as --as says, for a terminal of so many columns (0: none). Throws UsageError for
/// arguments that are not understood, naming the nearest command or flag.
Printed answer_to(std::vector<std::string> arguments, std::size_t columns);

/// Parses as `answer_to` does and runs nothing.
void check_line(std::vector<std::string> arguments);

}  // namespace mosbench
