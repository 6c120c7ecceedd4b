#include "datasets/doctor/truth_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kFewPoints = 3;

/// Every second scan is labelled; nothing is labelled moving but one point of one scan, if given.
class QuietSequence : public Sequence {
 public:
  QuietSequence(std::size_t scans, std::optional<std::size_t> moving_scan) : moving_(moving_scan) {
    for (std::size_t k = 0; k < scans; ++k) {
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stem = std::to_string(k);
      entry.points = kFewPoints;
      entry.has_truth = k % 2 == 0;
    }
  }
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    describe(scan_index, frame);
    frame.points.assign(kFewPoints, Point{5, 1, 0, 0});
    add_truth(scan_index, frame);
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    std::vector<std::uint32_t> labels(kFewPoints, kStaticLabel);
    if (scan_index == moving_) labels.front() = kMovingLabel;
    return labels;
  }

 private:
  std::optional<std::size_t> moving_;
};

TruthCheck checked(std::size_t scans, std::optional<std::size_t> moving_scan = {}) {
  return check_truth(QuietSequence(scans, moving_scan), std::vector<Pose>(scans, Pose::Identity()),
                     true);
}

TEST(TruthWithoutAnythingMoving, IsANoteInAnExcerpt) {
  const TruthCheck check = checked(600);
  EXPECT_THAT(check.findings, IsEmpty());
  EXPECT_THAT(check.remarks, ElementsAre("no point of 300 labelled scans is labelled moving: the "
                                         "IoU of these labels is undefined"));
}

TEST(TruthWithoutAnythingMoving, IsAFindingOverMoreThanAMinute) {
  const TruthCheck check = checked(603);
  EXPECT_THAT(check.findings, ElementsAre("no point of 302 labelled scans is labelled moving; "
                                          "expected some in a sequence over 603 scans"));
  EXPECT_THAT(check.remarks, IsEmpty());
}

TEST(TruthWithoutAnythingMoving, IsLookedForInAllScans) {
  const TruthCheck check = checked(603, 2);
  EXPECT_EQ(check.moving, 0U);  // not among the dozen examined
  EXPECT_THAT(check.findings, IsEmpty());
  EXPECT_THAT(check.remarks, IsEmpty());
}

}  // namespace
}  // namespace mosbench
