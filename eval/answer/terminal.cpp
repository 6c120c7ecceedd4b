#include "eval/answer/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

namespace mosbench {
namespace {

constexpr std::string_view kBetween = "  ";
constexpr std::string_view kRed = "\x1b[31m", kYellow = "\x1b[33m", kGreen = "\x1b[32m",
                           kBold = "\x1b[1m", kPlain = "\x1b[0m";

bool is_heading(std::string_view line) {
  constexpr std::array<std::string_view, 5> kWords = {
      "Arguments:", "Options:", "Examples:", "Commands:", "Reading:"};
  return line.starts_with("Usage: ") || std::ranges::find(kWords, line) != kWords.end();
}

std::string_view style_of(std::string_view line) {
  if (line.starts_with("error:") || line == "regression") return kRed;
  if (line.starts_with("warning:")) return kYellow;
  if (line == "pass") return kGreen;
  return is_heading(line) ? kBold : std::string_view();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Begin and end of a column.
using Span = std::pair<std::size_t, std::size_t>;

/// The columns that a line of dashes marks; none where it is another line.
std::vector<Span> columns_below(std::string_view line) {
  if (line.empty() || line.find_first_not_of("- ") != std::string_view::npos) return {};
  std::vector<Span> columns;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    columns.emplace_back(begin, end);
    begin = std::min(line.find_first_not_of(' ', end), line.size());
  }
  return columns;
}

/// The columns of each fold: as many as have room beside the first one.
std::vector<std::vector<Span>> folds_of(const std::vector<Span>& columns, std::size_t room) {
  std::vector<std::vector<Span>> folds = {{columns.front()}};
  std::size_t used = columns.front().second;
  for (const Span& column : std::span(columns).subspan(1)) {
    const std::size_t width = column.second - column.first + kBetween.size();
    if (used + width > room && folds.back().size() > 1) {
      folds.push_back({columns.front()});
      used = columns.front().second;
    }
    folds.back().push_back(column);
    used += width;
  }
  return folds;
}

/// The text of a line in a column, with blanks up to its width.
std::string cell_of(const std::string& line, const Span& column) {
  const auto [begin, end] = column;
  const std::string cell = begin < line.size() ? line.substr(begin, end - begin) : "";
  return cell + std::string(end - begin - cell.size(), ' ');
}

std::string cells_of(const std::string& line, const std::vector<Span>& columns) {
  std::string cells;
  for (const Span& column : columns) {
    if (&column != columns.data()) cells += kBetween;
    cells += cell_of(line, column);
  }
  cells.erase(cells.find_last_not_of(' ') + 1);
  return cells + '\n';
}

/// The same of two columns, the second of which goes on in the next line where there is no room.
std::string broken_cells(const std::string& line, const std::vector<Span>& columns,
                         std::size_t room) {
  const std::size_t indent = columns.front().second + kBetween.size();
  std::istringstream words(cell_of(line, columns.back()));
  std::string cells = cell_of(line, columns.front()) + std::string(kBetween);
  std::size_t used = indent;
  for (std::string word; words >> word; used += word.size()) {
    if (word.find_first_not_of('-') == std::string::npos)
      word.resize(std::min(word.size(), room - indent));
    if (used > indent && used + 1 + word.size() > room) {
      cells += '\n' + std::string(indent, ' ');
      used = indent;
    } else if (used > indent) {
      cells += ' ';
      ++used;
    }
    cells += word;
  }
  cells.erase(cells.find_last_not_of(' ') + 1);
  return cells + '\n';
}

std::string row_of(const std::string& line, const std::vector<Span>& fold, std::size_t room) {
  constexpr std::size_t kLeastRoom = 20;  // for words in the second of two columns
  const std::string whole = cells_of(line, fold);
  const std::size_t first = fold.front().second + kBetween.size();
  if (fold.size() != 2 || whole.size() <= room + 1 || first + kLeastRoom > room) return whole;
  return broken_cells(line, fold, room);
}

/// Whether a line ends where the columns of a table do, as titles and rows without trailing blanks
/// do.
bool fits(const std::string& line, const std::vector<Span>& columns) {
  return !line.empty() && line.size() <= columns.back().second;
}

}  // namespace

std::string folded_tables(const std::string& answer, std::size_t room) {
  const std::vector<std::string> lines = lines_of(answer);
  const bool fits_as_it_is =
      std::ranges::all_of(lines, [&](const auto& line) { return line.size() <= room; });
  if (room == 0 || fits_as_it_is) return answer;
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto columns = i + 1 < lines.size() ? columns_below(lines[i + 1]) : std::vector<Span>();
    if (columns.size() < 2 || columns.back().second <= room || !fits(lines[i], columns)) {
      text += lines[i] + '\n';
      continue;
    }
    std::size_t end = i;
    while (end < lines.size() && fits(lines[end], columns)) ++end;
    const auto folds = folds_of(columns, room);
    for (const auto& fold : folds) {
      if (&fold != folds.data()) text += '\n';
      for (std::size_t row = i; row < end; ++row) text += row_of(lines[row], fold, room);
    }
    i = end - 1;
  }
  return text;
}

std::size_t terminal_columns() {
  winsize size{};
  if (isatty(STDOUT_FILENO) != 1 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return 0;
  return size.ws_col;
}

bool shows_colours(int stream) {
  const char* terminal = std::getenv("TERM");
  const char* refused = std::getenv("NO_COLOR");
  if (refused != nullptr && *refused != '\0') return false;
  return isatty(stream) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string in_colours(const std::string& answer) {
  std::string text;
  for (std::size_t start = 0; start < answer.size();) {
    const std::size_t end = std::min(answer.find('\n', start), answer.size());
    const std::string_view line = std::string_view(answer).substr(start, end - start);
    const std::string_view style = style_of(line);
    text += style;
    text += line;
    if (!style.empty()) text += kPlain;
    if (end < answer.size()) text += '\n';
    start = end + 1;
  }
  return text;
}

}  // namespace mosbench
