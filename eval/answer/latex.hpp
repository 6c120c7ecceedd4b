#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mosbench {

/// Returns `text` as one line of LaTeX that prints it, also within a comment.
std::string latex_text(std::string_view text);

/// Returns the cells as one row of a tabular, each as `latex_text`.
std::string latex_row(std::span<const std::string> cells);

}  // namespace mosbench
