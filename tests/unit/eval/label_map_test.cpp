#include <gtest/gtest.h>

#include <array>

#include "eval/protocols/protocol.hpp"

namespace mosbench {
namespace {

constexpr std::array kRanges = {IdRange{0, 9, TruthClass::kStatic},
                                IdRange{251, 65535, TruthClass::kMoving},
                                IdRange{65535, 65535, TruthClass::kIgnored}};

TEST(LabelTable, GivesEveryIdOfARangeItsClass) {
  const LabelTable table(IdMap{kRanges, TruthClass::kIgnored});
  EXPECT_EQ(table[0], TruthClass::kStatic);
  EXPECT_EQ(table[9], TruthClass::kStatic);
  EXPECT_EQ(table[251], TruthClass::kMoving);
  EXPECT_EQ(table[65534], TruthClass::kMoving);
}

TEST(LabelTable, LetsALaterRangeOverrideAnEarlierOne) {
  const LabelTable table(IdMap{kRanges, TruthClass::kIgnored});
  EXPECT_EQ(table[65535], TruthClass::kIgnored);
  EXPECT_TRUE(table.is_known(65535));
}

TEST(LabelTable, GivesUnlistedIdsTheUnknownClassAndTellsThemApart) {
  const LabelTable table(IdMap{kRanges, TruthClass::kStatic});
  EXPECT_EQ(table[10], TruthClass::kStatic);
  EXPECT_FALSE(table.is_known(10));
  EXPECT_TRUE(table.is_known(9));
}

TEST(LabelTable, LooksAtTheLower16BitsOnly) {
  const LabelTable table(IdMap{kRanges, TruthClass::kIgnored});
  EXPECT_EQ(table[0x000500FB], TruthClass::kMoving);
  EXPECT_EQ(table[0xFFFF0009], TruthClass::kStatic);
  EXPECT_EQ(table[0xFFFFFFFF], TruthClass::kIgnored);
}

}  // namespace
}  // namespace mosbench
