#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "eval/confusion.hpp"
#include "eval/metrics.hpp"
#include "eval/protocol.hpp"
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

class ParityScore : public testing::TestWithParam<parity::ParityCase> {
 protected:
  void SetUp() override {
    if (!parity::parity_root()) GTEST_SKIP() << parity::kSkipMessage;
  }
};

TEST_P(ParityScore, CountsPerScanEqualTheCaseWithUnlabelledIgnored) {
  const std::vector<Confusion> scans =
      score_expected(GetParam(), protocol_named("semantickitti-mos"));
  ASSERT_EQ(scans.size(), GetParam().per_scan_unlabelled_ignored.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    EXPECT_EQ(counts_of(scans[k]), GetParam().per_scan_unlabelled_ignored[k]) << "scan " << k;
  }
  const Summary summary = summarize(protocol_named("semantickitti-mos"), scans);
  EXPECT_EQ(counts_of(summary.pooled), GetParam().truth_unlabelled_ignored);
  EXPECT_EQ(summary.pooled.points(), GetParam().points);
  EXPECT_EQ(summary.pooled.unknown_ids, 0U);
}

TEST_P(ParityScore, RawLabelsGiveTheSameCountsWhereNoInstanceStands) {
  std::size_t compared = 0;
  for (std::size_t k = 0; k < GetParam().scans; ++k) {
    const std::vector<std::uint32_t> truth = parity::truth_of(GetParam(), k);
    if (has_standing_instance(truth)) continue;
    const Confusion scan = score_scan(protocol_named("semantickitti-mos"), truth,
                                      parity::expected_of(GetParam(), k), {});
    EXPECT_EQ(counts_of(scan), GetParam().per_scan_unlabelled_ignored[k]) << "scan " << k;
    ++compared;
  }
  EXPECT_GE(compared, GetParam().scans * 9 / 10);
}

TEST_P(ParityScore, PooledCountsEqualTheCaseWithUnlabelledStatic) {
  const Protocol& protocol = protocol_named("sipailou");
  const Summary summary = summarize(protocol, score_expected(GetParam(), protocol));
  EXPECT_EQ(counts_of(summary.pooled), GetParam().truth_unlabelled_static);
  EXPECT_EQ(summary.pooled.tp + summary.pooled.fp, GetParam().predicted_moving_points);
  EXPECT_EQ(summary.pooled.ignored, 0U);
}

INSTANTIATE_TEST_SUITE_P(Case, ParityScore, testing::ValuesIn(parity::parity_cases()),
                         [](const auto& parity) { return parity.param.name; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ParityScore);

TEST(ParityCases, AreThereOrTheSkipSaysSo) {
  if (!parity::shared_parity_folder()) GTEST_SKIP() << parity::kSkipMessage;
  EXPECT_FALSE(parity::parity_cases().empty());
}

}  // namespace
}  // namespace mosbench
