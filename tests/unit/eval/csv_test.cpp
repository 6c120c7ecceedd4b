#include "eval/answer/csv.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace mosbench {
namespace {

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

}  // namespace
}  // namespace mosbench
