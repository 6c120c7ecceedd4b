#include "eval/answer/markdown.hpp"

#include "datasets/text/shown_text.hpp"

namespace mosbench {

std::string markdown_text(std::string_view text) {
  std::string escaped;
  for (const char c : shown_in_line(text)) {
    // Brackets of intervals stay: only a parenthesis behind makes them a link.
    const bool of_link = c == '(' && escaped.ends_with(']');
    if (of_link || std::string_view("\\|`*<>").find(c) != std::string_view::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string markdown_row(std::span<const std::string> cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line += ' ' + markdown_text(cell) + " |";
  return line + '\n';
}

}  // namespace mosbench
