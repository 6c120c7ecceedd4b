#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
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

constexpr std::size_t kLookedAt = 20;

Point point_at(double up_deg, double around_deg, double range_m) {
  constexpr double kRad = 3.14159265358979 / 180;
  const double level_m = range_m * std::cos(up_deg * kRad);
  return {static_cast<float>(level_m * std::cos(around_deg * kRad)),
          static_cast<float>(level_m * std::sin(around_deg * kRad)),
          static_cast<float>(range_m * std::sin(up_deg * kRad)), 0};
}

/// Scans of a sensor that stands still.
class LookingScans : public Sequence {
 public:
  using Rays = std::function<void(std::size_t scan_index, std::vector<Point>& points)>;
  explicit LookingScans(Rays rays) : rays_(std::move(rays)) {
    for (std::size_t k = 0; k < 2 * kLookedAt; ++k) {
      mutable_recording().scans.emplace_back().stem = std::to_string(k);
    }
  }
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    describe(scan_index, frame);
    rays_(scan_index, frame.points);
  }
  std::vector<std::uint32_t> read_truth(std::size_t) const override { return {}; }

 private:
  Rays rays_;
};

/// A wall 10 m away in rows from `lowest_deg` on, in one scan with a pole 5 m away.
LookingScans pole_before_wall(int lowest_deg, int step_deg) {
  return LookingScans([=](std::size_t scan_index, std::vector<Point>& points) {
    for (int up_deg = lowest_deg; up_deg <= 10; up_deg += step_deg) {
      for (int around = -40; around <= 40; ++around) {
        const bool is_pole = scan_index == kLookedAt && std::abs(around) <= 1;
        points.push_back(point_at(up_deg + 0.5, 0.5 * around, is_pole ? 5 : 10));
      }
    }
  });
}

/// How many points nearer than 9 m are what, and those farther.
std::map<std::pair<bool, Stay>, std::size_t> counted_stays(const Sequence& sequence) {
  const Frame frame = sequence.read(kLookedAt);
  const std::vector<Stay> stays = stays_of(sequence, kLookedAt, frame.points);
  std::map<std::pair<bool, Stay>, std::size_t> counts;
  for (std::size_t i = 0; i < stays.size(); ++i) {
    const Point& point = frame.points[i];
    ++counts[{std::hypot(point.x, point.y, point.z) < 9, stays[i]}];
  }
  return counts;
}

TEST(PointsThatOtherScansLookAt, LeaveWhereAllReturnsAndTheNextBelowAreBeyond) {
  for (const int step_deg : {1, 2}) {
    auto counts = counted_stays(pole_before_wall(-10, step_deg));
    const std::size_t rows = 20U / static_cast<unsigned>(step_deg) + 1U;
    EXPECT_EQ((counts[{true, Stay::kLeaves}]), 3 * (rows - 1)) << "but for the lowest row";
    EXPECT_EQ((counts[{true, Stay::kUnseen}]), 3U);
    EXPECT_EQ((counts[{false, Stay::kLeaves}]), 0U);
    EXPECT_GT((counts[{false, Stay::kStays}]), 700U);
  }
}

TEST(PointsThatOtherScansLookAt, StayOnGroundThatRowsHitNearerAndFarther) {
  const auto ground = [](std::vector<Point>& points, double up_deg) {
    const double range_m = 0.7 / std::sin(-up_deg * 3.14159265358979 / 180);
    for (int around = -40; around <= 40; ++around) {
      points.push_back(point_at(up_deg, 0.5 * around + 0.25, range_m));
    }
  };
  auto counts = counted_stays(LookingScans([&](std::size_t k, std::vector<Point>& points) {
    if (k == kLookedAt) return ground(points, -2.5);
    ground(points, -2.05);
    ground(points, -4.5);
  }));
  EXPECT_EQ((counts[{false, Stay::kStays}]), 81U);
}

TEST(PointsThatOtherScansLookAt, AreOfScansWithOthersOnBothSides) {
  EXPECT_THAT(scans_to_look_at(QuietSequence(120, {})),
              ElementsAre(5U, 15U, 25U, 35U, 45U, 55U, 65U, 75U, 85U, 95U, 105U, 115U));
  EXPECT_THAT(scans_to_look_at(QuietSequence(2, {})), ElementsAre(0U, 1U));
}

}  // namespace
}  // namespace mosbench
