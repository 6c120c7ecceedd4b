#pragma once

#include <cstddef>
#include <string>

namespace mosbench {

/// Returns how many columns the terminal behind stdout has; 0 where stdout is none.
std::size_t terminal_columns();

/// Returns whether a terminal behind `stream` (a file descriptor) is to be shown colours: not where
/// the environment has NO_COLOR (no-color.org) or TERM=dumb.
bool shows_colours(int stream);

/// Returns an answer with its findings in colour: lines that begin with "error:" or are
/// "regression" in red, "warning:" in yellow, "pass" in green, and the headings of help in bold.
std::string in_colours(const std::string& answer);

}  // namespace mosbench
