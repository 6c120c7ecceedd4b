#pragma once

#include <string>
#include <vector>

namespace mosbench {

/// Rows of cells printed in columns as wide as their widest cell: the first column to the left,
/// numbers to the right.
class TextTable {
 public:
  enum class Align { kLeft, kRight };
  static constexpr Align kLeft = Align::kLeft;
  struct Column {
    std::string title;
    Align align = Align::kRight;
  };

  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// Shorter rows are filled with empty cells.
  void add_row(std::vector<std::string> cells);
  /// A line between the rows before and after.
  void add_rule() { rows_.emplace_back(); }
  /// All lines, each ended by a line feed and without trailing blanks.
  std::string str() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace mosbench
