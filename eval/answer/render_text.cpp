#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

constexpr std::string_view kBetween = "  ";

/// Lines of cells in columns, and how wide those are.
struct Layout {
  const ShownTable& table;
  std::vector<std::size_t> widths;
};

Layout layout_of(const ShownTable& table) {
  Layout layout{table, {}};
  for (std::size_t c = 0; c < table.heads.size(); ++c) {
    std::size_t width = table.heads[c].title.size();
    for (const auto& row : table.rows) {
      if (!row.empty()) width = std::max(width, row[c].size());
    }
    layout.widths.push_back(width);
  }
  return layout;
}

/// The columns of each fold: as many as have room beside the first one.
std::vector<std::vector<std::size_t>> folds_of(const Layout& layout, std::size_t room) {
  std::vector<std::vector<std::size_t>> folds = {{0}};
  std::size_t used = layout.widths.front();
  for (std::size_t c = 1; c < layout.widths.size(); ++c) {
    const std::size_t width = layout.widths[c] + kBetween.size();
    if (room > 0 && used + width > room && folds.back().size() > 1) {
      folds.push_back({0});
      used = layout.widths.front();
    }
    folds.back().push_back(c);
    used += width;
  }
  return folds;
}

std::string without_trailing_blanks(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + '\n';
}

std::string padded(const Layout& layout, std::size_t column, const std::string& cell) {
  const std::size_t width = layout.widths[column];
  return layout.table.heads[column].is_left ? fmt::format("{:<{}}", cell, width)
                                            : fmt::format("{:>{}}", cell, width);
}

/// Two columns, the second of which goes on in the next line where there is no room.
std::string broken_line(const Layout& layout, std::size_t first, const std::string& left,
                        const std::string& right, std::size_t room) {
  const std::size_t indent = layout.widths[first] + kBetween.size();
  std::istringstream words(right);
  std::string line = padded(layout, first, left) + std::string(kBetween);
  std::size_t used = indent;
  for (std::string word; words >> word; used += word.size()) {
    if (used > indent && used + 1 + word.size() > room) {
      line += '\n' + std::string(indent, ' ');
      used = indent;
    } else if (used > indent) {
      line += ' ';
      ++used;
    }
    line += word;
  }
  return without_trailing_blanks(std::move(line));
}

std::string line_of(const Layout& layout, const std::vector<std::size_t>& fold,
                    const std::vector<std::string>& cells, std::size_t room) {
  constexpr std::size_t kLeastRoom = 20;  // for words in the second of two columns
  std::string line;
  for (const std::size_t column : fold) {
    if (column != fold.front()) line += kBetween;
    line += padded(layout, column, cells[column]);
  }
  line = without_trailing_blanks(std::move(line));
  const std::size_t first = layout.widths[fold.front()] + kBetween.size();
  if (room == 0 || fold.size() != 2 || line.size() <= room + 1 || first + kLeastRoom > room) {
    return line;
  }
  return broken_line(layout, fold.front(), cells[fold.front()], cells[fold.back()], room);
}

std::string table_text(const ShownTable& table, std::size_t room) {
  const Layout layout = layout_of(table);
  std::vector<std::string> titles;
  for (const ShownTable::Head& head : table.heads) titles.push_back(head.title);
  std::string text;
  for (const auto& fold : folds_of(layout, room)) {
    std::vector<std::string> dashes;
    const std::size_t first = layout.widths[fold.front()] + kBetween.size();
    for (std::size_t c = 0; c < layout.widths.size(); ++c) {
      const bool is_cut = fold.size() == 2 && c == fold.back() && room >= first + 20;
      dashes.emplace_back(is_cut ? std::min(layout.widths[c], room - first) : layout.widths[c],
                          '-');
    }
    if (!text.empty()) text += '\n';
    text += line_of(layout, fold, titles, room) + line_of(layout, fold, dashes, room);
    for (const auto& row : table.rows) {
      text += line_of(layout, fold, row.empty() ? dashes : row, room);
    }
  }
  return text;
}

std::string lines_text(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

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

}  // namespace

std::string text_of(const Sheet& sheet, std::size_t columns) {
  std::string text;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : "\n") + part;
  };
  add((sheet.title.empty() ? "" : sheet.title + '\n') + lines_text(sheet.lead));
  if (!sheet.columns.empty()) add(table_text(shown_table(sheet), columns));
  add(lines_text(sheet.notes));
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
