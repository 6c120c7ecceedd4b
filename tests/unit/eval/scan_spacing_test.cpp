#include <gtest/gtest.h>

#include "eval/statistics/run_statistics.hpp"

namespace mosbench {
namespace {

Spacing spacing_of(const Result& result) { return mosbench::spacing_of({&result, 1}); }

/// A sequence with a row per name; those that a star ends have truth.
Result sequence_of(const std::vector<std::string>& names) {
  Result result;
  result.sequence = SequenceName("street", "street");
  result.protocol = &protocol_named("doals-hmm");
  for (const std::string& name : names) {
    ScanRow& row = result.scans.emplace_back();
    const bool labelled = name.ends_with('*');
    row.stem = name.substr(0, name.size() - (labelled ? 1 : 0));
    if (labelled) row.counts.emplace();
  }
  return result;
}

std::vector<std::string> numbered(std::size_t scans, std::size_t labelled_every) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < scans; ++k) {
    names.push_back(std::to_string(k) + (k % labelled_every == 0 ? "*" : ""));
  }
  return names;
}

TEST(SpacingOf, IsFarForScansThatAreTenSecondsApart) {
  // Labelled scans of DOALS, shopville/sequence_2, as `score` writes them.
  EXPECT_EQ(spacing_of(sequence_of({"199*", "399*", "527*", "599*", "799*", "999*", "1199*",
                                    "1399*", "1599*", "1799*"})),
            Spacing::kFar);
  EXPECT_EQ(spacing_of(sequence_of(numbered(1000, 100))), Spacing::kFar) << "as `run` does";
  std::vector<std::string> unnamed = numbered(1000, 100);
  for (std::string& name : unnamed) name = "scan-" + name;
  EXPECT_EQ(spacing_of(sequence_of(unnamed)), Spacing::kFar) << "unlabelled scans between";
}

TEST(SpacingOf, IsNearForScansInARow) {
  EXPECT_EQ(spacing_of(sequence_of(numbered(20, 1))), Spacing::kNear);
  EXPECT_EQ(spacing_of(sequence_of(numbered(400, 4))), Spacing::kNear) << "HeLiMOS";
  EXPECT_EQ(spacing_of(sequence_of({"a*", "b*"})), Spacing::kNear);
  EXPECT_EQ(spacing_of(sequence_of({"7*"})), Spacing::kNear) << "nothing is known";
  EXPECT_EQ(spacing_of(sequence_of({})), Spacing::kNear);
}

TEST(SpacingOf, IsNearWhereHalfOfTheScansAreNear) {
  EXPECT_EQ(spacing_of(sequence_of({"100*", "101*", "300*", "301*", "500*", "501*"})),
            Spacing::kNear);
}

TEST(SpacingOf, TakesLongNumbersForNanoseconds) {
  EXPECT_EQ(spacing_of(sequence_of({"1600000000000000000*", "1600000000100000000*"})),
            Spacing::kNear);
  EXPECT_EQ(spacing_of(sequence_of({"1600000000000000000*", "1600000010000000000*"})),
            Spacing::kFar);
}

TEST(SpacingOf, IsThatOfAllSequencesTogether) {
  const Result far = sequence_of({"0*", "150*"});
  EXPECT_EQ(mosbench::spacing_of(std::vector{far, sequence_of({"0*", "100*"})}), Spacing::kFar);
  EXPECT_EQ(mosbench::spacing_of(std::vector{far, sequence_of({"0*", "10*"})}), Spacing::kNear);
}

}  // namespace
}  // namespace mosbench
