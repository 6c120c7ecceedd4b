#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/statistics/run_statistics.hpp"

namespace mosbench {
namespace {

/// A run of one scan, whose truth has this hash.
ResultSet run_on(std::optional<LabelHash> truth_hash) {
  Result street;
  street.sequence = SequenceName("street", "street");
  street.protocol = &protocol_named("sipailou");
  ScanRow& scan = street.scans.emplace_back();
  scan.stem = "000017";
  scan.counts.emplace();
  scan.truth_hash = truth_hash;
  return {.path = "street", .sequences = {street}};
}

TEST(PairedRuns, SayWhereTheirTruthDiffersOrIsUnknown) {
  const auto unlike = [](std::optional<LabelHash> first, std::optional<LabelHash> second) {
    const ResultSet one = run_on(first), other = run_on(second);
    return unlike_text(pair_runs(one, other).unlike);
  };
  EXPECT_EQ(unlike(LabelHash{1}, LabelHash{1}), "");
  EXPECT_EQ(unlike(LabelHash{1}, LabelHash{2}),
            "sequence street: the truth of scan 000017 differs");
  EXPECT_EQ(unlike(LabelHash{1}, {}), "sequence street: scan 000017 does not state its truth");
}

}  // namespace
}  // namespace mosbench
