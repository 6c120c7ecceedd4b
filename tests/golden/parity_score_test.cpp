#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <vector>

#include "eval/protocols/confusion.hpp"
#include "eval/protocols/metrics.hpp"
#include "eval/protocols/protocol.hpp"
#include "tests/parity_cases.hpp"

namespace mosbench {
namespace {

parity::Counts counts_of(const Confusion& confusion) {
  return {confusion.tp, confusion.fp, confusion.fn};
}

// The simulated sequences hold an instance number in the upper 16 bits, also on objects that stand
// still for a moment (id 9). case.json was counted on the whole 32 bits, so those points count as
// moving there, although every protocol looks at the lower 16 bits only.
std::uint32_t as_counted_in_case_json(std::uint32_t label) { return label > 250 ? 251 : label; }

bool has_standing_instance(const std::vector<std::uint32_t>& truth) {
  return std::ranges::any_of(
      truth, [](std::uint32_t label) { return (label & 0xFFFFU) <= 250 && label > 250; });
}

/// The authors' labels of one case, scored scan by scan against the truth of case.json.
std::vector<Confusion> score_expected(const parity::ParityCase& parity, const Protocol& protocol) {
  std::vector<Confusion> scans;
  for (std::size_t k = 0; k < parity.scans; ++k) {
    std::vector<std::uint32_t> truth = parity::truth_of(parity, k);
    std::ranges::transform(truth, truth.begin(), as_counted_in_case_json);
    scans.push_back(score_scan(protocol, truth, parity::expected_of(parity, k), {}));
  }
  return scans;
}

class ParityScore : public testing::Test {
 protected:
  void SetUp() override {
    if (!parity::parity_root()) GTEST_SKIP() << parity::kSkipMessage;
    ASSERT_FALSE(cases_.empty());
  }
  const std::vector<parity::ParityCase> cases_ = parity::parity_cases();
};

TEST_F(ParityScore, CountsPerScanEqualTheCaseWithUnlabelledIgnored) {
  const Protocol& protocol = protocol_named("semantickitti-mos");
  for (const parity::ParityCase& parity : cases_) {
    SCOPED_TRACE(parity.name);
    const std::vector<Confusion> scans = score_expected(parity, protocol);
    std::vector<parity::Counts> counts;
    std::ranges::transform(scans, std::back_inserter(counts), counts_of);
    EXPECT_EQ(counts, parity.per_scan_unlabelled_ignored);
    const Summary summary = summarize(protocol, scans);
    EXPECT_EQ(counts_of(summary.pooled), parity.truth_unlabelled_ignored);
    EXPECT_EQ(summary.pooled.points(), parity.points);
    EXPECT_EQ(summary.pooled.unknown_ids, 0U);
  }
}

TEST_F(ParityScore, PooledCountsEqualTheCaseWithUnlabelledStatic) {
  const Protocol& protocol = protocol_named("sipailou");
  for (const parity::ParityCase& parity : cases_) {
    SCOPED_TRACE(parity.name);
    const Summary summary = summarize(protocol, score_expected(parity, protocol));
    EXPECT_EQ(counts_of(summary.pooled), parity.truth_unlabelled_static);
    EXPECT_EQ(summary.pooled.tp + summary.pooled.fp, parity.predicted_moving_points);
    EXPECT_EQ(summary.pooled.ignored, 0U);
  }
}

TEST_F(ParityScore, RawLabelsGiveTheSameCountsWhereNoInstanceStands) {
  for (const parity::ParityCase& parity : cases_) {
    SCOPED_TRACE(parity.name);
    std::size_t compared = 0;
    for (std::size_t k = 0; k < parity.scans; ++k) {
      const std::vector<std::uint32_t> truth = parity::truth_of(parity, k);
      if (has_standing_instance(truth)) continue;
      const Confusion scan = score_scan(protocol_named("semantickitti-mos"), truth,
                                        parity::expected_of(parity, k), {});
      EXPECT_EQ(counts_of(scan), parity.per_scan_unlabelled_ignored[k]) << "scan " << k;
      ++compared;
    }
    EXPECT_GE(compared, parity.scans * 9 / 10);
  }
}

}  // namespace
}  // namespace mosbench
