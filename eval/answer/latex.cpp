#include "eval/answer/latex.hpp"

#include "datasets/text/shown_text.hpp"

namespace mosbench {
namespace {

std::string latex_character(char c) {
  switch (c) {
    case '\\':
      return "\\textbackslash{}";
    case '~':
      return "\\textasciitilde{}";
    case '^':
      return "\\textasciicircum{}";
    default:
      break;
  }
  const bool special = std::string_view("&%$#_{}").find(c) != std::string_view::npos;
  return special ? std::string("\\") + c : std::string(1, c);
}

}  // namespace

std::string latex_text(std::string_view text) {
  std::string escaped;
  for (const char c : shown_in_line(text)) escaped += latex_character(c);
  return escaped;
}

std::string latex_row(std::span<const std::string> cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != cells.data()) line += " & ";
    line += latex_text(cell);
  }
  return line + " \\\\\n";
}

}  // namespace mosbench
