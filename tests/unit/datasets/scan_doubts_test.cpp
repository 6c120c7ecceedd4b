#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "datasets/doctor/doctor.hpp"
#include "datasets/simulator/simulate.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using ChangeFrame = std::function<void(std::size_t, Frame&)>;

std::unique_ptr<Sequence> short_walk() {
  static const TempFolder folder;
  static const bool is_simulated = [] {
    simulate({.layout = DatasetKind::kSemanticKitti,
              .scene = "room",
              .scans = 12,
              .seed = 5,
              .out = folder / "walk",
              .threads = 2});
    return true;
  }();
  EXPECT_TRUE(is_simulated);
  return std::move(open_dataset(folder / "walk", {}).sequences.front());
}

/// A walk whose scans are changed while they are read.
class OtherScans : public SequenceAround {
 public:
  explicit OtherScans(ChangeFrame change)
      : SequenceAround(short_walk()), change_(std::move(change)) {}
  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override {
    inner().read(scan_index, frame);
    change_(scan_index, frame);
  }
  void set_pose(std::size_t scan_index, const Pose& pose) {
    mutable_recording().scans.at(scan_index).map_from_sensor = pose;
  }

 private:
  ChangeFrame change_;
};

std::vector<std::string> doubts_with(const ChangeFrame& change) {
  OtherScans scans(change);
  return add_doubts_of_scans(DatasetKind::kSemanticKitti, scans);
}

void keep_frame(std::size_t, Frame&) {}

TEST(DoubtsOfScans, AreNoneOfASoundWalk) { EXPECT_THAT(doubts_with(keep_frame), IsEmpty()); }

TEST(DoubtsOfScans, AreAddedOnce) {
  OtherScans scans([](std::size_t, Frame& frame) {
    for (Point& point : frame.points) point = {1e3F * point.x, 1e3F * point.y, 1e3F * point.z, 0};
  });
  const auto said = ElementsAre(HasSubstr("; expected metres (are these millimetres or feet?)"));
  EXPECT_THAT(add_doubts_of_scans(DatasetKind::kSemanticKitti, scans), said);
  EXPECT_THAT(scans.recording().doubts, said);
  EXPECT_THAT(add_doubts_of_scans(DatasetKind::kSemanticKitti, scans), IsEmpty());
  EXPECT_EQ(scans.recording().doubts.size(), 1U);
}

TEST(DoubtsOfScans, NameTurnsThatAreStoredInParts) {
  const auto quarter = [](std::size_t scan_index, Frame& frame) {
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const Point& point = frame.points[i];
      const double turns = 0.5 + std::atan2(point.y, point.x) / (2.0 * M_PI);
      if (static_cast<std::size_t>(4.0 * turns) % 4 != scan_index % 4) lose_point(frame, i);
    }
  };
  EXPECT_THAT(doubts_with(quarter),
              ElementsAre(HasSubstr("of the directions in common that they see (median); expected "
                                    "most: is each turn stored in parts?")));
}

TEST(DoubtsOfScans, NameLabelsThatAreNotTheDataSets) {
  const auto classes = [](std::size_t, Frame& frame) {
    for (std::uint32_t& label : *frame.truth) label = label > 250 ? 2 : 1;
  };
  EXPECT_THAT(doubts_with(classes),
              ElementsAre(HasSubstr("the labels are 1, 2, as the classes of a network; expected")));
}

TEST(DoubtsOfScans, SayThatEqualPosesAreWrongOnlyWhereTheSensorMoves) {
  OtherScans moving(keep_frame),
      standing([](std::size_t, Frame&frame) { frame = short_walk()->read(0); });
  for (OtherScans* scans : {&moving, &standing}) {
    for (std::size_t k = 0; k < scans->size(); ++k) scans->set_pose(k, Pose::Identity());
  }
  EXPECT_THAT(doubts_of(moving), ElementsAre(HasSubstr("all 12 poses are equal; expected")));
  EXPECT_THAT(doubts_of(standing), IsEmpty());
}

}  // namespace
}  // namespace mosbench
