#include "datasets/doctor/pose_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "datasets/doctor/doctor.hpp"
#include "datasets/simulator/simulate.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;
using Change = std::function<void(std::vector<Pose>&)>;

std::unique_ptr<Sequence> opened_drive(const OpenOptions& options = {}) {
  static const TempFolder folder;
  static const bool is_simulated = [] {
    simulate({.layout = DatasetKind::kSemanticKitti,
              .scene = "street",
              .scans = 46,
              .seed = 5,
              .out = folder / "drive",
              .threads = 2});
    return true;
  }();
  EXPECT_TRUE(is_simulated);
  return std::move(open_dataset(folder / "drive", options).sequences.front());
}

/// A drive whose poses were changed; the scans are as they were.
class OtherPoses : public SequenceAround {
 public:
  explicit OtherPoses(const Change& change, const OpenOptions& options = {})
      : SequenceAround(opened_drive(options)) {
    std::vector<Pose> poses = poses_of(*this);
    change(poses);
    mutable_recording().scans.resize(poses.size());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      mutable_recording().scans[k].map_from_sensor = poses[k];
    }
  }
};

void keep(std::vector<Pose>&) {}

Change drift(double share) {
  return [share](std::vector<Pose>& poses) {
    const Eigen::Vector3d start_m = poses.front().translation();
    for (Pose& pose : poses) pose.translation() += share * (pose.translation() - start_m);
  };
}

void jitter(std::vector<Pose>& poses) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise_m(0.0, 0.05), noise_rad(0.0, 0.5 * M_PI / 180.0);
  for (Pose& pose : poses) {
    for (int axis = 0; axis < 3; ++axis) {
      pose.translate(noise_m(random) * Eigen::Vector3d::Unit(axis));
      pose.rotate(Eigen::AngleAxisd(noise_rad(random), Eigen::Vector3d::Unit(axis)));
    }
  }
}

/// Puts the poses of the last third along a way that turns too much, by 0.1 degrees a scan.
void turn_at_the_end(std::vector<Pose>& poses) {
  const std::vector<Pose> given = poses;
  for (std::size_t k = 2 * poses.size() / 3; k < poses.size(); ++k) {
    const Eigen::AngleAxisd turn(0.1 * M_PI / 180.0, Eigen::Vector3d::UnitZ());
    poses[k] = poses[k - 1] * (given[k - 1].inverse() * given[k]) * turn;
  }
}

Facts facts_of(const Sequence& sequence) {
  Facts facts;
  examine_pose_fit(sequence, poses_of(sequence), FitDetail::kFull, facts);
  return facts;
}

std::string found_in(const Change& change) {
  const auto found = judged(checks(), Subject::kFit, facts_of(OtherPoses(change)), "08");
  return found.empty() ? "" : found.front().what;
}

TEST(PoseFit, SoundPosesFitWithinTwoCentimetres) {
  const Facts facts = facts_of(OtherPoses(keep));
  EXPECT_GE(*facts.number("places"), 10.0);
  EXPECT_EQ(*facts.number("off_places"), 0.0);
  EXPECT_LT(*facts.number("fit_10_cm"), 2.0);
  EXPECT_LT(*facts.number("match_cm"), 2.0);
  EXPECT_TRUE(judged(checks(), Subject::kFit, facts, "08").empty());
  EXPECT_EQ(doubt_about_pose_fit(OtherPoses(keep)), std::nullopt);
}

TEST(PoseFit, NamesDriftWithItsSizeAndTheWorstStretch) {
  const Facts facts = facts_of(OtherPoses(drift(0.03)));
  // The car drives 16 m in 20 scans; surfaces are off by the share across which it drives.
  EXPECT_GT(*facts.number("fit_10_cm"), 8.0);
  EXPECT_LT(*facts.number("fit_10_cm"), 0.03 * 1700.0);
  const std::string found = found_in(drift(0.03));
  EXPECT_THAT(found, HasSubstr("the poses drift: over 20 scans they put surfaces 10 m away "));
  EXPECT_THAT(found, HasSubstr(" places, scan matching errs by "));
  EXPECT_THAT(found, HasSubstr(", worst from scan 0000"));
  EXPECT_THAT(found, HasSubstr("; expected at most 4 cm: run with "));
  EXPECT_THAT(found_in(drift(0.01)), HasSubstr("the poses drift"));
}

TEST(PoseFit, NamesJitterAndPlaces) {
  EXPECT_THAT(found_in(jitter), HasSubstr("the poses jitter from scan to scan: "));
  EXPECT_THAT(found_in(turn_at_the_end), HasSubstr(" of 12 places: "));
}

TEST(PoseFit, DoubtsARunFromFewScans) {
  const auto late = [](std::vector<Pose>& poses) {
    poses.erase(poses.begin());
    poses.push_back(poses.back());
  };
  for (const Change& change : {drift(0.03), Change(jitter), Change(late)}) {
    const auto doubt = doubt_about_pose_fit(OtherPoses(change));
    ASSERT_TRUE(doubt);
    EXPECT_THAT(*doubt, HasSubstr("the poses do not fit the scans: over "));
  }
}

/// The first scans of the drive, with poses that were changed before.
Change only(std::size_t scans, const Change& change) {
  return [=](std::vector<Pose>& poses) {
    change(poses);
    poses.resize(scans);
  };
}

void invert(std::vector<Pose>& poses) {
  for (Pose& pose : poses) pose = pose.inverse();
}

void scale_to_millimetres(std::vector<Pose>& poses) {
  for (Pose& pose : poses) pose.translation() *= 1e3;
}

TEST(PoseFit, DoubtsShortRunsToo) {
  for (const Change& change : {Change(jitter), Change(invert), Change(scale_to_millimetres)}) {
    const auto doubt = doubt_about_pose_fit(OtherPoses(only(12, change)));
    ASSERT_TRUE(doubt);
    EXPECT_THAT(*doubt, HasSubstr("the poses do not fit the scans: over "));
  }
  EXPECT_THAT(*doubt_about_pose_fit(OtherPoses(scale_to_millimetres)),
              HasSubstr("run with odometry simple"));
  EXPECT_THAT(*doubt_about_pose_fit(OtherPoses(drift(0.03))), HasSubstr("run with refine_poses"));
  for (const std::size_t scans : {5U, 12U}) {
    EXPECT_EQ(doubt_about_pose_fit(OtherPoses(only(scans, keep))), std::nullopt);
  }
  EXPECT_EQ(doubt_about_pose_fit(OtherPoses(only(4, invert))), std::nullopt);
}

TEST(PoseFit, NamesASingleJumpAndASingleRow) {
  const auto jump = [](std::vector<Pose>& poses) {
    for (std::size_t k = 20; k < poses.size(); ++k) poses[k].pretranslate(Eigen::Vector3d(0, 2, 0));
  };
  const auto single = [](std::vector<Pose>& poses) {
    poses[9].translate(Eigen::Vector3d(0, 3, 0));
  };
  const auto by_jump = doubt_about_pose_fit(OtherPoses(jump));
  ASSERT_TRUE(by_jump);
  EXPECT_THAT(*by_jump, HasSubstr("the poses jump between scans 000019 and 000020: they move by "));
  const auto by_row = doubt_about_pose_fit(OtherPoses(only(14, single)));
  ASSERT_TRUE(by_row);
  EXPECT_THAT(*by_row, HasSubstr("the poses jump between scans 0000"));
}

TEST(PoseFit, DoubtsNoDisturbedPoses) {
  OpenOptions options;
  options.reading.perturb.emplace().steps = {{"pose_noise_m", 0.2}};
  EXPECT_EQ(doubt_about_pose_fit(OtherPoses(keep, options)), std::nullopt);
}

TEST(PoseFit, TellsNothingOfScansThatShareNothing) {
  class Empty : public OtherPoses {
   public:
    Empty() : OtherPoses(keep) {}
    using Sequence::read;
    void read(std::size_t scan_index, Frame& frame) const override { describe(scan_index, frame); }
  };
  EXPECT_EQ(facts_of(Empty()).number("places"), std::nullopt);
}

}  // namespace
}  // namespace mosbench
