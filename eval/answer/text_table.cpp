#include "eval/answer/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/shown_text.hpp"

namespace mosbench {

void TextTable::add_row(std::vector<std::string> cells) {
  cells.resize(columns_.size());
  for (std::string& cell : cells) cell = shown_in_line(cell);
  rows_.push_back(std::move(cells));
}

std::string TextTable::str() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    widths.push_back(columns_[c].title.size());
    for (const auto& row : rows_) {
      if (!row.empty()) widths[c] = std::max(widths[c], row[c].size());
    }
  }
  std::string text;
  const auto add_line = [&](const auto& cell_of) {
    std::string line;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      line += columns_[c].align == Align::kLeft ? fmt::format("{:<{}}", cell_of(c), widths[c])
                                                : fmt::format("{:>{}}", cell_of(c), widths[c]);
      line += "  ";
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  };
  const auto add_dashes = [&] {
    add_line([&](std::size_t c) { return std::string(widths[c], '-'); });
  };
  add_line([&](std::size_t c) { return columns_[c].title; });
  add_dashes();
  for (const auto& row : rows_) {
    if (row.empty()) {
      add_dashes();
    } else {
      add_line([&](std::size_t c) { return row[c]; });
    }
  }
  return text;
}

}  // namespace mosbench
