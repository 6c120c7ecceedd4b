#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/formats/bin_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/sequence_names.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

/// 1000 times the instance and the id, to be read in a failure.
std::vector<std::uint32_t> readable(const std::vector<std::uint32_t>& truth) {
  std::vector<std::uint32_t> readable;
  for (const std::uint32_t label : truth) {
    readable.push_back(1000 * (label >> 16U) + (label & 0xFFFFU));
  }
  return readable;
}

const std::string kRest = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

/// A packet of a car that drives east with 10 m/s, the IMU 1 m before the LiDAR.
std::string packet(std::size_t frame) {
  const double reach_m = 6378137.0 * std::cos(49.0 * std::numbers::pi / 180.0);
  return fmt::format("49 {} 100 0 0 0",
                     8.0 + static_cast<double>(frame) / reach_m * 180.0 / std::numbers::pi) +
         kRest;
}

std::string stamp(std::size_t frame) {
  return fmt::format("2011-09-26 13:02:2{}.{}00000000\n", frame / 10, frame % 10);
}

/// Points beside each other: of what keeps its distance, of the parked car that comes nearer, of
/// the road, and behind the camera.
std::vector<Point> points_of(std::size_t frame) {
  const float parked = 20.0F - static_cast<float>(frame);
  return {{15, 3, -1, 0}, {parked, -2, -1, 0}, {15, 6, -1, 0}, {-10, 0, -1, 0}, {15, 4.01F, -1, 0}};
}

std::string tracklet(const char* type, std::size_t first_frame, const std::vector<double>& x_m,
                     double y_m) {
  std::string text = fmt::format(
      "<item><objectType>{}</objectType><h>2</h><w>2</w><l>4</l><first_frame>{}</first_frame>"
      "<poses><count>{}</count>",
      type, first_frame, x_m.size());
  for (const double x : x_m) {
    text += fmt::format(
        "<item><tx>{}</tx><ty>{}</ty><tz>-2</tz><rx>0</rx><ry>0</ry><rz>0</rz></item>", x, y_m);
  }
  return text + "</poses></item>";
}

std::string tracklets(const std::vector<std::string>& items) {
  std::string text = fmt::format("<boost_serialization><tracklets><count>{}</count>", items.size());
  for (const std::string& item : items) text += item;
  return text + "</tracklets></boost_serialization>";
}

/// Six frames of one drive; frame 2 was not scanned.
class KittiRawDrive : public testing::Test {
 protected:
  static constexpr std::size_t kFrames = 6;
  static constexpr const char* kDrive = "root/2011_09_26/2011_09_26_drive_0001_sync/";

  KittiRawDrive() {
    write("root/2011_09_26/calib_imu_to_velo.txt",
          "calib_time: 25-May-2012 16:47:16\nR: 1 0 0 0 1 0 0 0 1\nT: 1 0 0\n");
    write("root/2011_09_26/calib_velo_to_cam.txt",
          "calib_time: x\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 0\ndelta_f: 0 0\n");
    write("root/2011_09_26/calib_cam_to_cam.txt",
          "corner_dist: 0.1\nS_rect_02: 1242 375\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
          "P_rect_02: 720 0 610 0 0 720 173 0 0 0 1 0\n");
    std::string stamps, scanned;
    for (std::size_t k = 0; k < kFrames; ++k) {
      write(drive(fmt::format("oxts/data/{:010}.txt", k)), packet(k));
      stamps += stamp(k);
      scanned += k == 2 ? "\n" : stamp(k);
      if (k == 2) continue;
      const std::vector<Point> points = points_of(k);
      write(drive(fmt::format("velodyne_points/data/{:010}.bin", k)),
            std::string(format_bin(points)));
    }
    write(drive("oxts/timestamps.txt"), stamps);
    write(drive("velodyne_points/timestamps.txt"), scanned);
    write(drive("tracklet_labels.xml"),
          tracklets({tracklet("Car", 0, std::vector<double>(kFrames, 15.0), 3.0),
                     tracklet("Van", 0, {20, 19, 18, 17, 16, 15}, -2.0)}));
  }

  void write(const std::string& file, const std::string& text) const { folder_.write(file, text); }
  static std::string drive(const std::string& file) { return kDrive + file; }
  Dataset opened(const Reading& reading = {}) const {
    return open_dataset(folder_ / "root", {.reading = reading});
  }
  std::string error_of_opening() const {
    return message_of<DataError>([&] { opened(); });
  }

  TempFolder folder_;
};

TEST_F(KittiRawDrive, IsNamedByItsNumber) {
  for (const char* name : {"0001", "drive_0001", "2011_09_26_drive_0001"}) {
    const Dataset dataset = open_dataset(folder_ / "root", {.sequences = {name}});
    EXPECT_THAT(sequence_names(dataset), ElementsAre("2011_09_26_drive_0001_sync")) << name;
  }
  const auto error_of = [&](const char* name) {
    return message_of<UsageError>([&] { open_dataset(folder_ / "root", {.sequences = {name}}); });
  };
  EXPECT_THAT(error_of("0011"), HasSubstr("expected one of 2011_09_26_drive_0001_sync"));
  EXPECT_THAT(error_of("001"), HasSubstr("no sequence \"001\""));
  // Of two dates the number says too little.
  std::filesystem::copy(folder_ / "root/2011_09_26", folder_ / "root/2011_09_27",
                        std::filesystem::copy_options::recursive);
  std::filesystem::rename(folder_ / "root/2011_09_27/2011_09_26_drive_0001_sync",
                          folder_ / "root/2011_09_27/2011_09_27_drive_0001_sync");
  EXPECT_THAT(error_of("0001"), HasSubstr("2011_09_27_drive_0001_sync"));
}

TEST_F(KittiRawDrive, IsReadBesideOneThatIsNotSynchronized) {
  folder_.write("root/2011_09_26/2011_09_26_drive_0001_extract/velodyne_points/data/0000000000.txt",
                "1 2 3 0\n");
  EXPECT_THAT(sequence_names(opened()), ElementsAre("2011_09_26_drive_0001_sync"));
  EXPECT_THAT(message_of<DataError>([&] {
                open_dataset(folder_ / "root/2011_09_26/2011_09_26_drive_0001_extract", {});
              }),
              HasSubstr("holds no frame, expected files *.bin"));
}

TEST_F(KittiRawDrive, IsReadByItsFrames) {
  const Dataset dataset = opened();
  EXPECT_EQ(dataset.kind, DatasetKind::kKittiRaw);
  EXPECT_THAT(sequence_names(dataset), ElementsAre("2011_09_26_drive_0001_sync"));
  const Sequence& sequence = *dataset.sequences.front();
  ASSERT_EQ(sequence.size(), 5U);
  EXPECT_EQ(sequence.stem(2), "0000000003");
  EXPECT_EQ(sequence.stamp_ns(2), 1'317'042'140'300'000'000);
  EXPECT_THAT(sequence.remarks(), Contains("1 frame has no scan, of 6"));
  for (const std::size_t scan : {0U, 2U}) {
    Pose expected = Pose::Identity();
    expected.translation().x() = scan == 0 ? 0.0 : 3.0;
    EXPECT_LT((sequence.map_from_sensor(scan).matrix() - expected.matrix()).norm(), 1e-6);
  }
  EXPECT_THAT(members_of(sequence.reading()), Contains(Pair("pose_frame", "lidar")));
}

TEST_F(KittiRawDrive, TurnsAboutTheImu) {
  write(drive("oxts/data/0000000001.txt"), "49 8 100 0 0 1.5707963267948966" + kRest);
  const Dataset dataset = opened();
  // The LiDAR is 1 m behind... of lidar_from_imu: the IMU lies 1 m ahead of it.
  const Eigen::Vector3d at = dataset.sequences.front()->map_from_sensor(1).translation();
  EXPECT_LT((at - Eigen::Vector3d(1, -1, 0)).norm(), 1e-6);
}

TEST_F(KittiRawDrive, HasTruthByTheSpeedOfItsBoxes) {
  const Dataset dataset = opened();
  const Sequence& sequence = *dataset.sequences.front();
  for (std::size_t scan = 0; scan < sequence.size(); ++scan) {
    EXPECT_THAT(readable(*sequence.read(scan).truth), ElementsAre(1251U, 2009U, 9U, 0U, 9U))
        << scan;
    EXPECT_EQ(sequence.read_truth(scan), *sequence.read(scan).truth);
  }
  const Dataset slow = opened({.moving_speed_m_s = 10.5});
  EXPECT_THAT(readable(slow.sequences.front()->read_truth(0)),
              ElementsAre(1009U, 2009U, 9U, 0U, 9U));
  EXPECT_THAT(members_of(slow.sequences.front()->reading()),
              Contains(Pair("truth", HasSubstr("moving from 10.5 m/s on"))));
}

TEST_F(KittiRawDrive, StandsOnTheBottomOfItsBoxes) {
  const std::vector<Point> points = {{15, 3, -2.01F, 0}, {15, 3, -1.99F, 0}, {15, 3, -0.01F, 0},
                                     {15, 3, 0.01F, 0},  {16.9F, 3, -1, 0},  {17.1F, 3, -1, 0}};
  write(drive("velodyne_points/data/0000000000.bin"), std::string(format_bin(points)));
  EXPECT_THAT(readable(opened().sequences.front()->read_truth(0)),
              ElementsAre(9U, 1251U, 1251U, 9U, 1251U, 9U));
}

TEST_F(KittiRawDrive, LeavesWhatIsSeenOnceUnlabelled) {
  write(drive("tracklet_labels.xml"), tracklets({tracklet("Car", 1, {15.0}, 3.0)}));
  const Dataset dataset = opened();
  EXPECT_THAT(dataset.sequences.front()->read_truth(1), ElementsAre(0U, 9U, 9U, 0U, 9U));
  EXPECT_THAT(dataset.sequences.front()->read_truth(0), ElementsAre(9U, 9U, 9U, 0U, 9U));
}

TEST_F(KittiRawDrive, HasNoTruthWithoutTracklets) {
  std::filesystem::remove(folder_ / drive("tracklet_labels.xml"));
  const Dataset dataset = opened();
  EXPECT_FALSE(dataset.sequences.front()->has_truth(0));
  EXPECT_THAT(dataset.sequences.front()->remarks(),
              Contains("no labels of objects: there is no truth"));
}

TEST_F(KittiRawDrive, IsFoundFromADriveADateAndAbove) {
  for (const char* place : {kDrive, "root/2011_09_26", "root"}) {
    std::optional<DatasetKind> kind;
    const auto found = find_sequences(folder_ / place, {}, kind);
    EXPECT_EQ(kind, DatasetKind::kKittiRaw) << place;
    ASSERT_EQ(found.size(), 1U) << place;
    EXPECT_EQ(found.front().alias, "2011_09_26_drive_0001");
  }
}

TEST_F(KittiRawDrive, LeavesOutScansWithoutPacket) {
  std::filesystem::remove(folder_ / drive("oxts/data/0000000003.txt"));
  const Dataset dataset = opened();
  EXPECT_EQ(dataset.sequences.front()->size(), 4U);
  EXPECT_THAT(dataset.sequences.front()->recording().doubts,
              Contains("1 scan has no packet in oxts and is left out"));
}

TEST_F(KittiRawDrive, TakesOtherPosesAndKeepsItsTruth) {
  folder_.write("p.tum", "1317042130 1 0 0 0 0 0 1\n1317042150 1 0 0 0 0 0 1\n");
  const Dataset dataset = opened({.poses = PoseFile{folder_ / "p.tum"}, .max_pose_gap_s = 60.0});
  EXPECT_EQ(dataset.sequences.front()->map_from_sensor(3).translation().x(), 1.0);
  EXPECT_THAT(readable(dataset.sequences.front()->read_truth(3)),
              ElementsAre(1251U, 2009U, 9U, 0U, 9U));
}

TEST_F(KittiRawDrive, HasNoTruthOfFramesWithoutPacketWhereverPosesComeFrom) {
  std::filesystem::remove(folder_ / drive("oxts/data/0000000003.txt"));
  folder_.write("p.tum", "1317042130 1 0 0 0 0 0 1\n1317042150 1 0 0 0 0 0 1\n");
  const Dataset dataset = opened({.poses = PoseFile{folder_ / "p.tum"}, .max_pose_gap_s = 60.0});
  ASSERT_EQ(dataset.sequences.front()->stem(2), "0000000003");
  EXPECT_FALSE(dataset.sequences.front()->has_truth(2)) << "what its boxes hold would be static";
  EXPECT_THAT(readable(dataset.sequences.front()->read_truth(3)),
              ElementsAre(1251U, 2009U, 9U, 0U, 9U));
}

TEST_F(KittiRawDrive, SaysWhatIsMissing) {
  write(drive("velodyne_points/timestamps.txt"), stamp(0) + "\n" + stamp(2));
  EXPECT_THAT(error_of_opening(),
              HasSubstr("velodyne_points/timestamps.txt: has no stamp for frame 1"));
  write(drive("velodyne_points/timestamps.txt"), stamp(0));
  EXPECT_THAT(error_of_opening(), HasSubstr("has no stamp for frame 1"));
  std::filesystem::remove(folder_ / drive("velodyne_points/timestamps.txt"));
  EXPECT_FALSE(opened().sequences.front()->stamp_ns(0));
  write(drive("oxts/timestamps.txt"), stamp(0));
  EXPECT_THAT(error_of_opening(), HasSubstr("oxts/timestamps.txt: has no stamp for frame 1"));
  std::filesystem::remove(folder_ / "root/2011_09_26/calib_velo_to_cam.txt");
  EXPECT_THAT(error_of_opening(), HasSubstr("calib_velo_to_cam.txt: is not there"));
}

TEST_F(KittiRawDrive, NeedsOxtsOrOtherPosesAndHasNoTruthWithoutOxts) {
  std::filesystem::remove_all(folder_ / drive("oxts"));
  EXPECT_THAT(message_of<MissingPoses>([&] { opened(); }),
              HasSubstr("2011_09_26_drive_0001_sync/oxts: is not there"));
  const Dataset dataset = opened({.poses = ByOdometry{}});
  EXPECT_EQ(dataset.sequences.front()->size(), 5U);
  EXPECT_FALSE(dataset.sequences.front()->has_truth(0));
  EXPECT_THAT(dataset.sequences.front()->remarks(),
              Contains(AllOf(HasSubstr("tracklet_labels.xml gives no truth"), HasSubstr("oxts"))));
  std::filesystem::remove(folder_ / drive("tracklet_labels.xml"));
  EXPECT_THAT(opened({.poses = ByOdometry{}}).sequences.front()->remarks(),
              Contains("no labels of objects: there is no truth"));
}

TEST_F(KittiRawDrive, NeedsItsCalibrationOrOtherPoses) {
  std::filesystem::remove(folder_ / "root/2011_09_26/calib_velo_to_cam.txt");
  EXPECT_THAT(message_of<MissingPoses>([&] { opened(); }),
              HasSubstr("calib_velo_to_cam.txt: is not there"));
  folder_.write("p.tum", "1317042130 1 0 0 0 0 0 1\n1317042150 1 0 0 0 0 0 1\n");
  const Dataset dataset = opened({.poses = PoseFile{folder_ / "p.tum"}, .max_pose_gap_s = 60.0});
  EXPECT_EQ(dataset.sequences.front()->map_from_sensor(3).translation().x(), 1.0);
  EXPECT_FALSE(dataset.sequences.front()->has_truth(3));
  EXPECT_THAT(dataset.sequences.front()->remarks(), Contains(HasSubstr("calib_velo_to_cam.txt")));
}

TEST_F(KittiRawDrive, RefusesTimesThatItsPointsDoNotHave) {
  EXPECT_THAT(message_of<UsageError>([&] { opened({.point_times = PointTimes::kColumn}); }),
              HasSubstr("expected azimuth or none"));
}

/// The same drive as a sequence of the tracking benchmark.
class KittiTrackingSequence : public testing::Test {
 protected:
  KittiTrackingSequence() {
    std::string oxts, labels;
    for (std::size_t k = 0; k < 4; ++k) {
      oxts += packet(k);
      // Camera x is lidar -y, camera z lidar x: 2 m high, its bottom 2 m below the camera.
      labels += fmt::format("{} 5 Car 0 0 0 0 0 9 9 2 2 4 -3 2 15 -1.5707963267948966\n", k);
      labels += fmt::format("{} 3 Van 0 0 0 0 0 9 9 2 2 4 2 2 {} -1.5707963267948966\n", k, 20 - k);
      labels += fmt::format("{} -1 DontCare -1 -1 -10 {} 0 {} 374 -1 -1 -1 -1000 -1000 -1000 -10\n",
                            k, k == 1 ? 0 : 5000, k == 1 ? 400 : 5001);
      if (k == 2) continue;
      const std::vector<Point> points = points_of(k);
      folder_.write(fmt::format("training/velodyne/0003/{:06}.bin", k), format_bin(points));
    }
    folder_.write("training/oxts/0003.txt", oxts);
    folder_.write("training/label_02/0003.txt", labels);
    folder_.write("training/calib/0003.txt",
                  "P2: 721.5377 0 610 0 0 721.5377 173 0 0 0 1 0\nR_rect 1 0 0 0 1 0 0 0 1\n"
                  "Tr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\nTr_imu_velo 1 0 0 1 0 1 0 0 0 0 1 0\n");
  }
  TempFolder folder_;
};

TEST_F(KittiTrackingSequence, IsReadAsItsDrive) {
  for (const char* place : {"", "training"}) {
    const Dataset dataset = open_dataset(folder_ / place, {});
    EXPECT_EQ(dataset.kind, DatasetKind::kKittiTracking);
    EXPECT_THAT(sequence_names(dataset), ElementsAre("0003"));
    const Sequence& sequence = *dataset.sequences.front();
    ASSERT_EQ(sequence.size(), 3U);
    EXPECT_EQ(sequence.stem(2), "000003");
    EXPECT_FALSE(sequence.stamp_ns(0));
    EXPECT_NEAR(sequence.map_from_sensor(2).translation().x(), 3.0, 1e-6);
    EXPECT_THAT(sequence.remarks(), Contains("1 frame has no scan, of 4"));
  }
}

TEST_F(KittiTrackingSequence, HasTruthByItsBoxesAndNoneWhereNobodyCared) {
  const Dataset dataset = open_dataset(folder_.path(), {});
  const Sequence& sequence = *dataset.sequences.front();
  EXPECT_THAT(readable(sequence.read_truth(0)), ElementsAre(6251U, 4009U, 9U, 0U, 9U))
      << "tracks 5 and 3";
  EXPECT_THAT(readable(sequence.read_truth(1)), ElementsAre(6251U, 4009U, 0U, 0U, 9U))
      << "a region holds the car, whose box is labelled, and the point beside it";
}

TEST_F(KittiTrackingSequence, TurnsBoxesAboutTheCamerasAxis) {
  const std::vector<Point> points = {{16.9F, 3, -1, 0},  {17.1F, 3, -1, 0},  {15, 4.1F, -1, 0},
                                     {15, 3, -1.99F, 0}, {15, 3, -2.01F, 0}, {15, 3, 0.01F, 0}};
  folder_.write("training/velodyne/0003/000000.bin", format_bin(points));
  EXPECT_THAT(readable(open_dataset(folder_.path(), {}).sequences.front()->read_truth(0)),
              ElementsAre(6251U, 9U, 9U, 6251U, 9U, 9U));
}

TEST_F(KittiTrackingSequence, TakesTheInstanceThatAWrittenBoxSays) {
  std::string labels;
  for (const int frame : {0, 1}) {
    labels +=
        fmt::format("{} 5 Object300 0 0 0 0 0 9 9 2 2 4 -3 2 15 -1.5707963267948966\n", frame);
  }
  folder_.write("training/label_02/0003.txt", labels);
  EXPECT_EQ(readable(open_dataset(folder_.path(), {}).sequences.front()->read_truth(0)).front(),
            300251U);
}

TEST_F(KittiTrackingSequence, IsReadWithoutLabelsAsTesting) {
  std::filesystem::rename(folder_ / "training", folder_ / "testing");
  std::filesystem::remove_all(folder_ / "testing/label_02");
  const Dataset dataset = open_dataset(folder_ / "testing", {});
  EXPECT_EQ(dataset.kind, DatasetKind::kKittiTracking);
  EXPECT_FALSE(dataset.sequences.front()->has_truth(0));
}

TEST_F(KittiTrackingSequence, IsKnownWithoutOxtsOrCalib) {
  for (const char* lacks : {"oxts", "calib"}) {
    std::filesystem::rename(folder_ / "training" / lacks, folder_ / "away");
    for (const char* place : {"", "training", "training/velodyne", "training/velodyne/0003"}) {
      EXPECT_THAT(message_of<MissingPoses>([&] { open_dataset(folder_ / place, {}); }),
                  HasSubstr(fmt::format("training/{}: is not there", lacks)))
          << place;
      const Dataset dataset = open_dataset(folder_ / place, {.reading = {.poses = ByOdometry{}}});
      EXPECT_EQ(dataset.kind, DatasetKind::kKittiTracking) << place;
      ASSERT_EQ(dataset.sequences.front()->size(), 3U);
      EXPECT_FALSE(dataset.sequences.front()->has_truth(0));
      EXPECT_THAT(dataset.sequences.front()->remarks(),
                  Contains(AllOf(HasSubstr("label_02/0003.txt gives no truth"),
                                 HasSubstr(std::string("training/") + lacks))));
    }
    std::filesystem::rename(folder_ / "away", folder_ / "training" / lacks);
  }
}

TEST_F(KittiTrackingSequence, TakesThePosesInAFolderOfScansThatIsGivenItself) {
  folder_.write("training/velodyne/0003/poses.txt",
                "1 0 0 7 0 1 0 0 0 0 1 0\n1 0 0 7 0 1 0 0 0 0 1 0\n1 0 0 7 0 1 0 0 0 0 1 0\n");
  const Dataset scans = open_dataset(folder_ / "training/velodyne/0003", {});
  EXPECT_EQ(scans.kind, DatasetKind::kRecording);
  EXPECT_EQ(scans.sequences.front()->map_from_sensor(0).translation().x(), 7.0);
  EXPECT_EQ(open_dataset(folder_.path(), {}).kind, DatasetKind::kKittiTracking);
}

TEST_F(KittiTrackingSequence, NamesTheFileThatOneSequenceLacks) {
  std::filesystem::remove(folder_ / "training/calib/0003.txt");
  EXPECT_THAT(message_of<MissingPoses>([&] { open_dataset(folder_.path(), {}); }),
              HasSubstr("training/calib/0003.txt: is not there"));
}

TEST_F(KittiTrackingSequence, LeavesFoldersOfScansWithPosesOfTheirOwnAlone) {
  for (const char* folder : {"training/oxts", "training/calib", "training/label_02"}) {
    std::filesystem::remove_all(folder_ / folder);
  }
  folder_.write("training/velodyne/0003/poses.txt",
                "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(open_dataset(folder_ / "training/velodyne/0003", {}).kind, DatasetKind::kRecording);
}

}  // namespace
}  // namespace mosbench
