#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "datasets/layouts/boxes.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;

/// The sensor drives along x with 10 m/s; frames are 0.1 s apart.
std::vector<std::optional<FramePose>> driven_frames(std::size_t count) {
  std::vector<std::optional<FramePose>> frames;
  for (std::size_t k = 0; k < count; ++k) {
    FramePose& frame = frames.emplace_back().emplace();
    frame.map_from_lidar.translation().x() = static_cast<double>(k);
    frame.stamp_ns = 1'317'042'145'000'000'000 + static_cast<std::int64_t>(k) * 100'000'000;
  }
  return frames;
}

TrackedBox box_at(std::size_t frame, double map_x_m) {
  TrackedBox box{frame, Pose::Identity(), Eigen::Vector3d(1, 1, 1)};
  box.lidar_from_box.translation().x() = map_x_m - static_cast<double>(frame);
  return box;
}

std::vector<std::uint32_t> labels_of(const BoxTrack& track, double moving_speed_m_s = 0.5,
                                     std::size_t frames = 20) {
  std::vector<std::uint32_t> labels;
  for (const auto& boxes : label_boxes({&track, 1}, driven_frames(frames), moving_speed_m_s)) {
    for (const LabelledBox& box : boxes) labels.push_back(box.label);
  }
  return labels;
}

TEST(LabelBoxes, JudgesSpeedInTheMap) {
  BoxTrack parked, ahead;
  for (std::size_t k = 0; k < 3; ++k) {
    parked.push_back(box_at(k, 30.0));
    ahead.push_back(box_at(k, 30.0 + static_cast<double>(k)));
  }
  EXPECT_THAT(labels_of(parked), ElementsAre(9U, 9U, 9U));
  EXPECT_THAT(labels_of(ahead), ElementsAre(251U, 251U, 251U)) << "it keeps its distance";
  EXPECT_THAT(labels_of(ahead, 10.1), ElementsAre(9U, 9U, 9U));
}

TEST(LabelBoxes, HoldsNoJitterForMotion) {
  BoxTrack shaken;
  for (std::size_t k = 0; k < 11; ++k) shaken.push_back(box_at(k, k % 2 == 0 ? 30.0 : 30.1));
  EXPECT_THAT(labels_of(shaken), testing::Each(9U))
      << "0.1 m within 0.1 s, but none in half a second";
}

TEST(LabelBoxes, SeesWhenAnObjectSetsOff) {
  BoxTrack track;
  for (std::size_t k = 0; k < 20; ++k) {
    track.push_back(box_at(k, 30.0 + 0.5 * std::max(0.0, static_cast<double>(k) - 10.0)));
  }
  const auto labels = labels_of(track);
  EXPECT_EQ(labels[4], 9U);
  EXPECT_EQ(labels[5], 9U) << "stands until half a second later";
  EXPECT_EQ(labels[10], 251U);
  EXPECT_EQ(labels[15], 251U);
}

TEST(LabelBoxes, KnowsNothingOfWhatIsSeenOnce) {
  EXPECT_THAT(labels_of({box_at(4, 30.0)}), ElementsAre(0U));
  EXPECT_THAT(labels_of({box_at(0, 30.0), box_at(15, 60.0)}), ElementsAre(251U, 251U))
      << "farther apart than half a second, but nothing is nearer";
  EXPECT_THAT(labels_of({box_at(4, 30.0), box_at(25, 30.0)}), ElementsAre(0U))
      << "a frame without pose";
}

TEST(LabelBoxes, KeepsTheInstanceOfWhatHasALabel) {
  std::vector<BoxTrack> tracks(2);
  tracks[0] = {box_at(1, 30.0), box_at(2, 35.0), box_at(3, 40.0)};
  for (TrackedBox& box : tracks[0]) box.instance = 7;
  tracks[1] = {box_at(1, 30.0), box_at(2, 30.0)};
  for (TrackedBox& box : tracks[1]) box.instance = 9;
  const auto boxes = label_boxes(tracks, driven_frames(4), 0.5);
  ASSERT_EQ(boxes[1].size(), 2U);
  EXPECT_EQ(boxes[1][0].label, 9U + (9U << 16U));
  EXPECT_EQ(boxes[1][1].label, 251U + (7U << 16U)) << "moving wins, whatever the instances";
  tracks[0] = {box_at(1, 30.0)};
  tracks[0].front().instance = 7;
  EXPECT_EQ(label_boxes({tracks.data(), 1}, driven_frames(4), 0.5)[1].front().label, 0U);
  EXPECT_EQ(instance_of_number(0), 1U);
  EXPECT_EQ(instance_of_number(65534), 65535U);
  EXPECT_EQ(instance_of_number(65535), 0U) << "it would be that of another";
  EXPECT_EQ(instance_of_number(~std::uint64_t{0}), 0U);
}

LabelledBox box_around(double x_m, double half_m, std::uint32_t label) {
  LabelledBox box{Pose::Identity(), Eigen::Vector3d::Constant(half_m), label};
  box.box_from_lidar.translation().x() = -x_m;
  return box;
}

TEST(IsUnlabelled, TakesABoxAroundAllAndNoLabelNearby) {
  const auto everything = box_around(0, 1e4, 0);
  EXPECT_TRUE(is_unlabelled(std::vector{everything}));
  EXPECT_FALSE(is_unlabelled({}));
  EXPECT_FALSE(is_unlabelled(std::vector{box_around(10, 209, 0)}));
  EXPECT_TRUE(is_unlabelled(std::vector{box_around(10, 210, 0)}));
  EXPECT_FALSE(is_unlabelled(std::vector{box_around(0, 1e4, 9)}));
  EXPECT_FALSE(is_unlabelled(std::vector{everything, box_around(30, 1, 251)}));
  EXPECT_TRUE(is_unlabelled(std::vector{everything, box_around(1e6, 1, 251 + (3U << 16U))}));
}

TEST(LabelBoxes, LetsMotionWin) {
  std::vector<BoxTrack> tracks(3);
  tracks[0] = {box_at(1, 30.0), box_at(2, 35.0)};
  tracks[1] = {box_at(1, 30.0), box_at(2, 30.0)};
  tracks[2] = {box_at(1, 30.0)};
  const auto boxes = label_boxes(tracks, driven_frames(3), 0.5);
  ASSERT_EQ(boxes[1].size(), 3U);
  EXPECT_EQ(boxes[1][0].label, 0U);
  EXPECT_EQ(boxes[1][1].label, 9U);
  EXPECT_EQ(boxes[1][2].label, 251U);
}

}  // namespace
}  // namespace mosbench
