#include "eval/answer/csv.hpp"

#include <fmt/format.h>

#include <string_view>

#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

bool is_formula(const std::string& cell) {
  constexpr std::string_view kStarts = "=+-@\t\r";
  return !cell.empty() && kStarts.find(cell.front()) != std::string_view::npos &&
         !parse_double(cell);
}

std::string csv_cell(const std::string& cell) {
  const bool formula = is_formula(cell);
  if (!formula && cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string quoted = formula ? "\"'" : "\"";
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string csv_row(std::span<const std::string> cells) {
  std::string line;
  for (const std::string& cell : cells) {
    if (&cell != cells.data()) line += ',';
    line += csv_cell(cell);
  }
  return line + '\n';
}

std::string csv_percent(const std::optional<double>& fraction) {
  return fraction ? fmt::format("{:.6g}", *fraction * 100.0) : "";
}

}  // namespace mosbench
