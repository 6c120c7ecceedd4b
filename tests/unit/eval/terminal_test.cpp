#include <gtest/gtest.h>

#include "eval/answer/render.hpp"

namespace mosbench {
namespace {

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
