// The authors' labels of the same real scans, online and delayed by ten scans.
#include <gtest/gtest.h>

#include "eval/protocols/confusion.hpp"
#include "eval/statistics/intervals.hpp"
#include "tests/parity_cases.hpp"

namespace mosbench {
namespace {

SequenceCounts per_scan_counts(const std::string& name) {
  for (const parity::ParityCase& parity : parity::parity_cases()) {
    if (parity.name != name) continue;
    SequenceCounts counts;
    for (const parity::Counts& scan : parity.per_scan_unlabelled_ignored) {
      Confusion confusion;
      confusion.tp = scan.tp;
      confusion.fp = scan.fp;
      confusion.fn = scan.fn;
      counts.push_back(confusion);
    }
    return counts;
  }
  return {};
}

TEST(PairedDifference, OfOnlineAndDelayedLabelsOfRealScansIsFound) {
  if (!parity::shared_parity_folder()) GTEST_SKIP() << parity::kSkipMessage;
  const Protocol& protocol = protocol_named("semantickitti-mos");
  const std::vector<SequenceCounts> online = {per_scan_counts("kitti_r50")};
  const std::vector<SequenceCounts> delayed = {per_scan_counts("kitti_r50_delay10")};
  ASSERT_EQ(online[0].size(), 50U);
  EXPECT_NEAR(estimate(protocol, online)[Metric::kIou].value.value(), 0.6229043109387876, 1e-15);
  const Difference iou = paired_difference(protocol, online, delayed)[Metric::kIou];
  const double expected = aggregate(protocol, delayed)[0] - aggregate(protocol, online)[0];
  EXPECT_DOUBLE_EQ(iou.value.value(), expected);
  // Five seconds of one street cannot tell what other streets would show.
  EXPECT_FALSE(iou.interval);
  EXPECT_FALSE(iou.p_value);
  EXPECT_EQ(iou.no_interval, "50 scans, expected at least 100 in a row, or 20 that are 10 s apart");
}

}  // namespace
}  // namespace mosbench
