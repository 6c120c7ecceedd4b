#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "datasets/text/shell_text.hpp"
#include "eval/answer/latex.hpp"
#include "eval/answer/markdown.hpp"

namespace mosbench {
namespace {

TEST(Markdown, KeepsWhatReadsAsItIs) {
  const std::string text = "paper-2024, voxel_size_m=0.2: 88.9 / 88.0 (-0.9) [87.1, 88.9]";
  EXPECT_EQ(markdown_text(text), text);
  EXPECT_EQ(markdown_row(std::vector<std::string>{"a", "", "b"}), "| a |  | b |\n");
}

TEST(Markdown, EscapesWhatWouldBreakARowOrBecomeMarkup) {
  EXPECT_EQ(markdown_row(std::vector<std::string>{"a|b\nc", "\\|"}),
            "| a\\|b\\\\x0ac | \\\\\\| |\n");
  EXPECT_EQ(markdown_text("<img src=x> [me](http://x) `code` *now*"),
            "\\<img src=x\\> [me]\\(http://x) \\`code\\` \\*now\\*");
}

TEST(Latex, EscapesEveryCharacterThatItReads) {
  EXPECT_EQ(latex_text("50 % & $1 #2 a_b {x}"), "50 \\% \\& \\$1 \\#2 a\\_b \\{x\\}");
  EXPECT_EQ(latex_text("\\input{/etc/passwd}"), "\\textbackslash{}input\\{/etc/passwd\\}");
  EXPECT_EQ(latex_text("~^"), "\\textasciitilde{}\\textasciicircum{}");
  EXPECT_EQ(latex_row(std::vector<std::string>{"a\nb", "c&d"}),
            "a\\textbackslash{}x0ab & c\\&d \\\\\n");
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
