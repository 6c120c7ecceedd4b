#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mosbench {

/// Returns `text` as one line of markdown that shows it: what would end a cell, begin a tag, a link
/// or an emphasis is escaped, line breaks become \x0a.
std::string markdown_text(std::string_view text);

/// Returns the cells as one line of a table, each as `markdown_text`.
std::string markdown_row(std::span<const std::string> cells);

}  // namespace mosbench
