#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>

#include "datasets/doctor/doctor.hpp"
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

/// What is found in the labels, and what was measured of them.
struct Judged {
  std::vector<std::string> findings, remarks;
  LabelEvidence labels;
};

Judged judged_labels(const Sequence& sequence) {
  SequenceCheckup checkup;
  examine_labels(sequence, checkup);
  Judged all;
  all.labels = *checkup.labels;
  for (const Symptom& symptom : judged(checks(), Subject::kLabels, checkup.facts, "labels")) {
    (symptom.severity == Severity::kNote ? all.remarks : all.findings).push_back(symptom.what);
  }
  return all;
}

Judged checked(std::size_t scans, std::optional<std::size_t> moving_scan = {}) {
  return judged_labels(QuietSequence(scans, moving_scan));
}

TEST(TruthWithoutAnythingMoving, IsANoteInAnExcerpt) {
  const Judged check = checked(600);
  EXPECT_THAT(check.findings, IsEmpty());
  EXPECT_THAT(check.remarks, ElementsAre("no point of 300 labelled scans is labelled moving: the "
                                         "IoU of these labels is undefined"));
}

TEST(TruthWithoutAnythingMoving, IsAFindingOverMoreThanAMinute) {
  const Judged check = checked(603);
  EXPECT_THAT(check.findings, ElementsAre("no point of 302 labelled scans is labelled moving; "
                                          "expected some in a sequence over 603 scans"));
  EXPECT_THAT(check.remarks, IsEmpty());
}

TEST(TruthWithoutAnythingMoving, IsLookedForInAllScans) {
  const Judged check = checked(603, 2);
  EXPECT_EQ(check.labels.moving, 0U);  // not among the dozen examined
  EXPECT_THAT(check.findings, IsEmpty());
  EXPECT_THAT(check.remarks, IsEmpty());
}

/// All scans have truth; only scan 7 and the one in its middle hold other labels than 0.
class KeyFrames : public QuietSequence {
 public:
  KeyFrames() : QuietSequence(60, 7) {
    for (ScanEntry& scan : mutable_recording().scans) scan.has_truth = true;
  }
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    if (scan_index != 7 && scan_index != 33) return std::vector<std::uint32_t>(kFewPoints, 0U);
    return QuietSequence::read_truth(scan_index);
  }
};

/// Returns what is said of labels, and of scans as a whole where labels are named.
std::vector<std::string> said_of_ids(const Sequence& sequence, SequenceCheckup& checkup) {
  examine_content(sequence, layout_of(DatasetKind::kSemanticKitti).files, 24, checkup);
  std::vector<std::string> said;
  for (const Subject subject : {Subject::kPoints, Subject::kLabelIds}) {
    for (const Symptom& symptom : judged(checks(), subject, checkup.facts, "frames")) {
      if (symptom.what.find("labels") != std::string::npos) said.push_back(symptom.what);
    }
  }
  return said;
}

TEST(TruthOfKeyFrames, IsLookedForAmongScansOfZeros) {
  const KeyFrames frames;
  EXPECT_THAT(scans_with_labels(frames), ElementsAre(7U, 33U));
  const LabelEvidence labels = judged_labels(frames).labels;
  EXPECT_EQ(labels.moving, 1U);
  EXPECT_EQ(labels.still, 5U);
  SequenceCheckup checkup;
  EXPECT_THAT(said_of_ids(frames, checkup), IsEmpty());
  EXPECT_EQ(checkup.points_of_id[kMovingLabel], 1U);
}

TEST(TruthOfKeyFrames, IsMissingWhereAllScansAreZeros) {
  class Zeros : public QuietSequence {
   public:
    Zeros() : QuietSequence(20, {}) {}
    std::vector<std::uint32_t> read_truth(std::size_t) const override {
      return std::vector<std::uint32_t>(kFewPoints, 0U);
    }
  };
  SequenceCheckup checkup;
  EXPECT_THAT(said_of_ids(Zeros(), checkup),
              testing::Contains("all labels of all scans are 0; expected labelled points"));
}

}  // namespace
}  // namespace mosbench
