#pragma once

#include <string>
#include <vector>

#include "eval/cli/commands.hpp"

namespace mosbench {

/// Parses the arguments that follow the program's name and runs the command they name. Throws
/// UsageError for arguments that are not understood, naming the nearest command or flag.
Answer answer_to(std::vector<std::string> arguments);

}  // namespace mosbench
