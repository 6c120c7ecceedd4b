#include "eval/answer/terminal.hpp"

#include <gtest/gtest.h>

#include "eval/answer/text_table.hpp"

namespace mosbench {
namespace {

TextTable wide_table() {
  TextTable table({{"run", TextTable::kLeft}, {"IoU"}, {"recall"}, {"ms"}});
  table.add_row({"mine", "61.2", "70.0", "9"});
  return table;
}

TEST(FoldedTables, FoldsIntoATerminalBesideItsFirstColumn) {
  EXPECT_EQ(folded_tables(wide_table().str(), 19),
            "run    IoU  recall\n"
            "----  ----  ------\n"
            "mine  61.2    70.0\n"
            "\n"
            "run   ms\n"
            "----  --\n"
            "mine   9\n");
  EXPECT_EQ(folded_tables(wide_table().str(), 26), wide_table().str()) << "it fits";
  EXPECT_EQ(folded_tables(wide_table().str(), 0), wide_table().str());
}

TEST(FoldedTables, ShowsAColumnThatIsWiderThanTheTerminalAllTheSame) {
  EXPECT_EQ(folded_tables(wide_table().str(), 3),
            "run    IoU\n----  ----\nmine  61.2\n\n"
            "run   recall\n----  ------\nmine    70.0\n\n"
            "run   ms\n----  --\nmine   9\n");
}

TEST(FoldedTables, BreaksTextBesideTheFirstColumn) {
  TextTable table({{"name", TextTable::kLeft}, {"why", TextTable::kLeft}});
  table.add_row({"a", "one two three four five six"});
  EXPECT_EQ(folded_tables(table.str(), 26),
            "name  why\n----  --------------------\na     one two three four\n      five six\n");
  EXPECT_EQ(folded_tables(table.str(), 25), table.str()) << "there is hardly room for words";
}

TEST(FoldedTables, FoldsBetweenLinesThatAreNoTable) {
  const std::string around = "a note that is longer than the terminal\n\n";
  EXPECT_EQ(folded_tables(around + wide_table().str() + "\n" + around, 19),
            around + folded_tables(wide_table().str(), 19) + "\n" + around);
  EXPECT_EQ(folded_tables("title\n-----\nrow of a list that is longer\n", 10),
            "title\n-----\nrow of a list that is longer\n");
}

TEST(Colours, MarkFindingsAndHeadingsAlone) {
  EXPECT_EQ(in_colours("Usage: x\nwarning: a\nno warning: b\nerror: c\npass\npassed"),
            "\x1b[1mUsage: x\x1b[0m\n\x1b[33mwarning: a\x1b[0m\nno warning: b\n"
            "\x1b[31merror: c\x1b[0m\n\x1b[32mpass\x1b[0m\npassed");
  EXPECT_EQ(in_colours(""), "");
  EXPECT_EQ(in_colours("{}\n"), "{}\n");
}

TEST(Colours, AreNotForFilesAndPipes) { EXPECT_FALSE(shows_colours(-1)); }

}  // namespace
}  // namespace mosbench
