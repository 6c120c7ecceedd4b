#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/text/text.hpp"
#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

/// The line of a table with these cells alone.
std::string table_in(const std::vector<std::string>& cells, Format format) {
  Sheet sheet{.columns = std::vector<Column>(cells.size(), Column{"c", Unit::kText})};
  sheet.rows.emplace_back(cells.begin(), cells.end());
  const std::string text = render({.sheets = {sheet}}, format);
  const std::string above = format == Format::kLatex ? "c \\\\\n\\hline\n" : "---|\n";
  const std::string line = text.substr(text.find(above) + above.size());
  return line.substr(0, line.find('\n') + 1);
}

TEST(Markdown, KeepsWhatReadsAsItIs) {
  const std::string text = "paper-2024, voxel_size_m=0.2: 88.9 / 88.0 (-0.9) [87.1, 88.9]";
  EXPECT_EQ(markdown_text(text), text);
  EXPECT_EQ(table_in({"a", "", "b"}, Format::kMarkdown), "| a |  | b |\n");
}

TEST(Markdown, EscapesWhatWouldBreakARowOrBecomeMarkup) {
  EXPECT_EQ(table_in({"a|b\nc", "\\|"}, Format::kMarkdown), "| a\\|b\\\\x0ac | \\\\\\| |\n");
  EXPECT_EQ(markdown_text("<img src=x> [me](http://x) `code` *now*"),
            "\\<img src=x\\> [me]\\(http://x) \\`code\\` \\*now\\*");
}

TEST(Latex, EscapesEveryCharacterThatItReads) {
  EXPECT_EQ(latex_text("50 % & $1 #2 a_b {x}"), "50 \\% \\& \\$1 \\#2 a\\_b \\{x\\}");
  EXPECT_EQ(latex_text("\\input{/etc/passwd}"), "\\textbackslash{}input\\{/etc/passwd\\}");
  EXPECT_EQ(latex_text("~^"), "\\textasciitilde{}\\textasciicircum{}");
  EXPECT_EQ(table_in({"a\nb", "c&d"}, Format::kLatex), "a\\textbackslash{}x0ab & c\\&d \\\\\n");
}

std::string row(const std::vector<std::string>& cells) { return csv_row(cells); }

TEST(CsvRow, KeepsPlainCellsAsTheyAre) {
  EXPECT_EQ(row({"00", "", "a b", "3.5"}), "00,,a b,3.5\n");
  EXPECT_EQ(row({""}), "\n");
}

TEST(CsvRow, QuotesWhatWouldBreakARow) {
  EXPECT_EQ(row({"a,b", "c"}), "\"a,b\",c\n");
  EXPECT_EQ(row({"say \"x\""}), "\"say \"\"x\"\"\"\n");
  EXPECT_EQ(row({"two\nlines", "x\ry"}), "\"two\nlines\",\"x\ry\"\n");
}

TEST(CsvRow, LeavesNumbersAndDisarmsFormulas) {
  EXPECT_EQ(row({"-0.9", "+3", "1e-5"}), "-0.9,+3,1e-5\n");
  EXPECT_EQ(row({"=1+1", "@x", "-a", "+b,c"}), "\"'=1+1\",\"'@x\",\"'-a\",\"'+b,c\"\n");
}

TEST(ShellWord, QuotesWhatAShellWouldRead) {
  EXPECT_EQ(shell_word("/data/kitti-08_x.d"), "/data/kitti-08_x.d");
  EXPECT_EQ(shell_word("my data; rm -rf ~"), "'my data; rm -rf ~'");
  EXPECT_EQ(shell_word("it's $(x)"), "'it'\\''s $(x)'");
  EXPECT_EQ(shell_word("~/x"), "'~/x'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace mosbench
