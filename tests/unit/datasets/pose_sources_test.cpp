#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <tuple>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/folder_sequence.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"
#include "tests/unit/datasets/pose_at_x.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Pair;

/// A quarter turn about z with the sensor at (1, 2, 3).
constexpr const char* kQuarterTurn = "0 -1 0 1 1 0 0 2 0 0 1 3";

TEST(PoseList, ReadsEachFormatAndTellsItFromTheRow) {
  const PoseList kitti = parse_pose_list(std::string(kQuarterTurn) + "\n", std::nullopt, "f");
  const PoseList tum = parse_pose_list(
      "# stamp tx ty tz qx qy qz qw\n0.5 1 2 3 0 0 0.70710678118654752 0.70710678118654752\n",
      std::nullopt, "f");
  const PoseList rollout = parse_pose_list(
      "1, 2, 3, 0, 0, 0.70710678118654752, 0.70710678118654752\n", std::nullopt, "f");
  EXPECT_EQ(kitti.format, PoseFormat::kKitti);
  EXPECT_EQ(tum.format, PoseFormat::kTum);
  EXPECT_EQ(rollout.format, PoseFormat::kRollout);
  ASSERT_EQ(tum.stamps_ns.size(), 1U);
  EXPECT_EQ(tum.stamps_ns[0], 500'000'000);
  for (const PoseList* list : {&tum, &rollout}) {
    ASSERT_EQ(list->poses.size(), 1U);
    EXPECT_TRUE(list->poses[0].matrix().isApprox(kitti.poses[0].matrix(), 1e-12));
  }
}

TEST(PoseList, RefusesRowsThatAreNoPose) {
  const auto error_of = [](const char* text) {
    return message_of<DataError>([&] { parse_pose_list(text, std::nullopt, "f"); });
  };
  EXPECT_THAT(error_of("1,2,3,0,0,0\n"), HasSubstr("f:1: 6 numbers in the row"));
  EXPECT_THAT(error_of("1,2,3,0,0,0,2\n"), HasSubstr("quaternion is not of length 1"));
  EXPECT_THAT(error_of("1,2,x,0,0,0,1\n"), HasSubstr("\"x\" is no finite number"));
  EXPECT_THAT(error_of("1 1 2 3 0 0 0 1\n0 1 2 3 0 0 0 1\n"),
              HasSubstr("f:2: its stamp is before that of the row before"));
  EXPECT_THAT(error_of("t 1 2 3 0 0 0 1\n"), HasSubstr("no time in seconds"));
}

TEST(PoseList, ReadsRowsAsSpreadsheetsAndMatricesHaveThem) {
  const auto read = [](const std::string& text) {
    return parse_pose_list(text, std::nullopt, "f");
  };
  const std::string row = "0.5 1 2 3 0 0 0 1";
  const auto separated = [&](char by) {
    std::string other = row;
    std::ranges::replace(other, ' ', by);
    return other + "\n";
  };
  for (const std::string& text :
       {row + "\n", separated(','), separated(';'), "\xEF\xBB\xBF" + row + "\n",
        "stamp,tx,ty,tz,qx,qy,qz,qw\n" + separated(','), "# made by hand, once\n" + row + "\n"}) {
    const PoseList list = read(text);
    EXPECT_EQ(list.format, PoseFormat::kTum);
    ASSERT_EQ(list.poses.size(), 1U) << text;
    EXPECT_EQ(list.poses[0].translation(), Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(list.stamps_ns[0], 500'000'000);
  }
  std::string commas = kQuarterTurn;
  std::ranges::replace(commas, ' ', ',');
  for (const std::string& text : {std::string(kQuarterTurn) + " 0 0 0 1\n", commas + "\n"}) {
    EXPECT_EQ(read(text).poses.at(0).matrix(), read(kQuarterTurn).poses.at(0).matrix());
    EXPECT_EQ(read(text).format, PoseFormat::kKitti);
  }
}

TEST(PoseList, LeavesRowsWithoutPoseOutAndSaysSo) {
  const PoseList list = parse_pose_list(
      "1 nan nan nan 0 0 0 1\n2 1 2 3 0 0 0 1\n3 1 2 3 NaN 0 0 1\n", std::nullopt, "dir/f");
  ASSERT_EQ(list.stamps_ns.size(), 1U);
  EXPECT_EQ(list.stamps_ns[0], 2'000'000'000);
  EXPECT_THAT(list.remarks("dir/f"),
              testing::ElementsAre("f: 2 rows have numbers that are NaN and are left out"));
}

TEST(PoseList, RefusesWhatWouldBeReadForOtherNumbers) {
  const auto error_of = [](const std::string& text) {
    return message_of<DataError>([&] { parse_pose_list(text, std::nullopt, "f"); });
  };
  EXPECT_THAT(error_of("# stamp tx ty tz qw qx qy qz\n0.5 1 2 3 1 0 0 0\n"),
              HasSubstr("f:1: its columns have quaternions as w x y z, expected x y z w"));
  EXPECT_THAT(error_of("0,5 1,0 2,0 3,0 0,0 0,0 0,0 1,0\n"),
              HasSubstr("is no finite number (is that a decimal comma?)"));
  EXPECT_THAT(error_of(std::string(kQuarterTurn) + " 0 0 0 2\n"),
              HasSubstr("16 numbers in the row"));
  EXPECT_THAT(error_of(std::string("\xFF\xFE"
                                   "1\0",
                                   4)),
              HasSubstr("is text in UTF-16, expected UTF-8"));
}

TEST(PoseList, TellsTheUnitOfStamps) {
  constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
  for (const auto& [unit, per_ns] :
       {std::pair{"s", 1'000'000'000}, {"ms", 1'000'000}, {"us", 1'000}, {"ns", 1}}) {
    for (const std::int64_t start_ns : {kStart_ns, std::int64_t{50'000'000'000}}) {
      std::string text;
      for (int k = 0; k < 8; ++k) {
        const std::int64_t stamp_ns = start_ns + k * 100'000'000;
        text += fmt::format("{}.{:03} 0 0 0 0 0 0 1\n", stamp_ns / per_ns,
                            stamp_ns % per_ns * 1000 / per_ns);
      }
      const PoseList list = parse_pose_list(text, std::nullopt, "f");
      EXPECT_EQ(to_string(unit_of_rows(text, "f")), unit);
      ASSERT_EQ(list.stamps_ns.size(), 8U);
      EXPECT_EQ(list.stamps_ns.back(), start_ns + 700'000'000);
    }
  }
}

TEST(PoseTrack, InterpolatesBetweenNeighboursAndNeverBeyondTheEnds) {
  Pose turned = pose_at_x(4.0);
  turned.linear() = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const PoseTrack track({{200, turned}, {100, pose_at_x(2.0)}});
  EXPECT_EQ(track.at(100)->matrix(), pose_at_x(2.0).matrix());
  EXPECT_EQ(track.at(200)->matrix(), turned.matrix());
  const Pose quarter = *track.at(125);
  EXPECT_DOUBLE_EQ(quarter.translation().x(), 2.5);
  EXPECT_TRUE(quarter.linear().isApprox(
      Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()).toRotationMatrix(), 1e-12));
  EXPECT_FALSE(track.at(99));
  EXPECT_FALSE(track.at(201));
  EXPECT_FALSE(PoseTrack().at(0));
}

TEST(Undistort, SaysWhenAPoseIsMissing) {
  const PoseTrack track({{0, pose_at_x(0.0)}, {100, pose_at_x(1.0)}});
  const PoseAt pose_at = [&](std::int64_t stamp_ns) { return track.at(stamp_ns); };
  std::vector<Point> points(2, Point{1, 1, 1, 1});
  EXPECT_FALSE(undistort(points, std::vector<std::int64_t>{0, 101}, 0, 0, pose_at));
  EXPECT_FALSE(undistort(points, std::vector<std::int64_t>{0, 100}, 0, -1, pose_at));
  points = {{1, 1, 1, 1}, {1, 1, 1, 1}};
  EXPECT_TRUE(undistort(points, std::vector<std::int64_t>{0, 100}, 0, 0, pose_at));
  EXPECT_EQ(points[0].x, 1.0F);
  EXPECT_EQ(points[1].x, 2.0F);
}

/// Three empty scans at 10.0, 10.1 and 10.2 s.
class PoseSources : public testing::Test {
 protected:
  PoseSources() {
    for (const char* stem : {"000000", "000001", "000002"}) {
      write_bin(folder_ / "velodyne" / (std::string(stem) + ".bin"), {});
    }
    folder_.write("times.txt", "10.0\n10.1\n10.2\n");
    folder_.write("calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
  }
  FolderSequence open(const Reading& options) const { return {"s", folder_.path(), options}; }
  double x_of(const FolderSequence& recording, std::size_t scan_index) const {
    return recording.read(scan_index).map_from_sensor.translation().x();
  }

  TempFolder folder_;
};

TEST_F(PoseSources, TakeStampedPosesAtTheScansStamps) {
  const auto poses = folder_.write(
      "tum.txt", "9.9 0 0 0 0 0 0 1\n10.1 2 0 0 0 0 0 1\n10.3 4 0 0 0 0 0 1\n11 9 0 0 0 0 0 1\n");
  const FolderSequence recording = open({.poses = PoseFile{poses}});
  EXPECT_DOUBLE_EQ(x_of(recording, 0), 1.0);
  EXPECT_EQ(x_of(recording, 1), 2.0);
  EXPECT_DOUBLE_EQ(x_of(recording, 2), 3.0);
  EXPECT_THAT(members_of(recording.reading()), Contains(Pair("pose_format", "tum")));
  EXPECT_THAT(members_of(recording.reading()), Contains(Pair("pose_frame", "lidar")));
  EXPECT_THAT(members_of(recording.reading()),
              Contains(Pair("pose_pairing", "by stamp, 2 of 3 interpolated")));
  const auto late = folder_.write("late.txt", "10.1 2 0 0 0 0 0 1\n10.3 4 0 0 0 0 0 1\n");
  const FolderSequence later = open({.poses = PoseFile{late}});
  ASSERT_EQ(later.size(), 2U);
  EXPECT_EQ(x_of(later, 0), 2.0);
  EXPECT_THAT(later.recording().doubts,
              Contains("1 of 3 scans are left out: they are before or after the "
                       "poses of late.txt"));
}

TEST_F(PoseSources, LeaveOutScansInGapsOfThePoses) {
  const auto gap = folder_.write("gap.txt", "10 1 0 0 0 0 0 1\n10.6 7 0 0 0 0 0 1\n");
  const FolderSequence recording = open({.poses = PoseFile{gap}});
  ASSERT_EQ(recording.size(), 1U);
  EXPECT_EQ(recording.stem(0), "000000");
  EXPECT_EQ(x_of(recording, 0), 1.0);
  ASSERT_EQ(recording.recording().left_out.size(), 2U);
  EXPECT_EQ(recording.recording().left_out[1].stem, "000002");
  EXPECT_THAT(recording.recording().doubts,
              Contains("2 of 3 scans are left out: they lie between poses more than 0.5 s apart in "
                       "gap.txt (max_pose_gap_s)"));
  EXPECT_THAT(
      members_of(recording.reading()),
      Contains(Pair("pose_pairing", "by stamp, 0 of 3 interpolated; 2 of 3 scans are left out")));
  EXPECT_EQ(open({.poses = PoseFile{gap}, .max_pose_gap_s = 0.6}).size(), 3U);
  EXPECT_EQ(open({.poses = PoseFile{gap}, .max_pose_gap_s = 0.59}).size(), 1U);
  const auto wide = folder_.write("wide.txt", "9 1 0 0 0 0 0 1\n12 7 0 0 0 0 0 1\n");
  EXPECT_THAT(
      message_of<DataError>([&] { open({.poses = PoseFile{wide}}); }),
      HasSubstr("wide.txt: all scans lie between poses more than 0.5 s apart, expected more "
                "poses, or a longer max_pose_gap_s"));
}

TEST_F(PoseSources, TakeRoundedStampsForThoseOfTheScans) {
  // Four decimals in the rows: stamps are rounded by up to 50 us.
  const auto poses = folder_.write(
      "rounded.txt", "10.0000 5 0 0 0 0 0 1\n10.1000 6 0 0 0 0 0 1\n10.2000 7 0 0 0 0 0 1\n");
  for (const auto& [first, last, scans] :
       {std::tuple("9.99996", "10.20004", 3), std::tuple("10.00004", "10.19996", 3),
        std::tuple("9.9999", "10.2", 2), std::tuple("10.0", "10.2001", 2)}) {
    folder_.write("times.txt", std::string(first) + "\n10.1\n" + last + "\n");
    const FolderSequence recording = open({.poses = PoseFile{poses}});
    ASSERT_EQ(recording.size(), static_cast<std::size_t>(scans)) << first;
    if (scans < 3) continue;
    EXPECT_EQ(x_of(recording, 0), 5.0) << first;
    EXPECT_EQ(x_of(recording, 2), 7.0) << last;
  }
}

TEST_F(PoseSources, KeepTheFirstOfRowsWithOneStamp) {
  for (const int repeated : {0, 1, 2}) {
    std::string rows;
    for (int k = 0; k < 3; ++k) {
      const std::string stamp = "10." + std::to_string(k);
      rows += stamp + " " + std::to_string(k) + " 0 0 0 0 0 1\n";
      if (k == repeated) rows += stamp + " 99 0 0 0 0 0 1\n";
    }
    const FolderSequence recording = open({.poses = PoseFile{folder_.write("twice.txt", rows)}});
    ASSERT_EQ(recording.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(x_of(recording, k), static_cast<double>(k));
    EXPECT_THAT(recording.recording().doubts,
                Contains("twice.txt: 1 row has the stamp of the row before and is left out"));
  }
}

/// Twenty scans every 0.1 s from 10.0 s.
class ManyPoseSources : public PoseSources {
 protected:
  ManyPoseSources() {
    std::string times;
    for (int k = 0; k < 20; ++k) {
      write_bin(folder_ / "velodyne" / (std::to_string(100 + k) + ".bin"), {});
      times += std::to_string(10.0 + 0.1 * k) + "\n";
    }
    for (const char* stem : {"000000", "000001", "000002"}) {
      std::filesystem::remove(folder_ / "velodyne" / (std::string(stem) + ".bin"));
    }
    folder_.write("times.txt", times);
  }
  std::filesystem::path poses(double factor, double offset_s, int per_scan = 1) const {
    std::string rows;
    for (int k = 0; k <= 19 * per_scan; ++k) {
      rows += std::to_string((10.0 + 0.1 * k / per_scan) * factor + offset_s) + " 1 0 0 0 0 0 1\n";
    }
    return folder_.write("many.txt", rows);
  }
};

TEST_F(ManyPoseSources, SayByHowMuchAllStampsAreOff) {
  const auto doubts = [&](double offset_s, int per_scan) {
    return open({.poses = PoseFile{poses(1.0, offset_s, per_scan)}}).recording().doubts;
  };
  for (const int per_scan : {1, 10}) {  // poses that are denser begin and end with the scans
    for (const double offset_s : {0.08, -0.03, 0.15}) {
      EXPECT_THAT(doubts(offset_s, per_scan),
                  Contains(HasSubstr(fmt::format("all stamps of many.txt are {:.1f} ms {} those",
                                                 std::abs(offset_s) * 1e3,
                                                 offset_s > 0 ? "after" : "before"))));
    }
    EXPECT_THAT(doubts(0.001, per_scan), testing::Not(Contains(HasSubstr("all stamps"))));
  }
}

TEST_F(ManyPoseSources, TakeStampsInTheUnitOfTheirSteps) {
  for (const auto& [factor, unit] : {std::pair{1e3, "ms"}, {1e6, "us"}, {1e9, "ns"}}) {
    const FolderSequence sequence = open({.poses = PoseFile{poses(factor, 0)}});
    EXPECT_EQ(sequence.size(), 20U) << unit;
    EXPECT_THAT(sequence.recording().doubts,
                Contains(fmt::format("the stamps of many.txt are taken as {}", unit)));
  }
}

TEST_F(ManyPoseSources, RefuseToGoOnWithFewScansOfMany) {
  const auto error = [&](double factor, double offset_s) {
    return message_of<DataError>([&] { open({.poses = PoseFile{poses(factor, offset_s)}}); });
  };
  const auto dense = poses(1e3, 0, 10);  // 10 may be seconds as well
  EXPECT_THAT(message_of<DataError>([&] { open({.poses = PoseFile{dense}}); }),
              HasSubstr("stamps in seconds: these fit as milliseconds"));
  EXPECT_THAT(error(1.0, 37.0), testing::AllOf(HasSubstr("holds poses for 0 of 20 scans"),
                                               HasSubstr("are 37000.0 ms after")));
  EXPECT_THAT(error(1.0, 1.85), HasSubstr("holds poses for 1 of 20 scans"));
}

TEST_F(PoseSources, InvertRolloutsAndWhateverIsToldToBeInverse) {
  const auto rollout = folder_.write("none.csv", "1,0,0,0,0,0,1\n2,0,0,0,0,0,1\n3,0,0,0,0,0,1\n");
  EXPECT_EQ(x_of(open({.poses = PoseFile{rollout}}), 2), -3.0);
  EXPECT_EQ(
      x_of(open({.poses = PoseFile{rollout}, .pose_direction = PoseDirection::kMapFromSensor}), 2),
      3.0);
  EXPECT_THAT(members_of(open({.poses = PoseFile{rollout}}).reading()),
              Contains(Pair("pose_direction", "sensor_from_map, inverted")));
}

TEST_F(PoseSources, TurnCameraPosesByTrUnlessToldOtherwise) {
  const std::string row = "1 0 0 0 0 1 0 0 0 0 1 5\n";  // 5 m along the camera's axis
  folder_.write("poses.txt", row + row + row);
  EXPECT_EQ(x_of(open({}), 0), 5.0);
  EXPECT_EQ(x_of(open({.pose_frame = PoseFrame::kLidar}), 0), 0.0);
  EXPECT_THAT(members_of(open({}).reading()),
              Contains(Pair("pose_frame", "camera, turned into the lidar's by Tr of calib.txt")));
  const auto tum = folder_.write("tum.txt", "9.9 0 0 5 0 0 0 1\n10.3 0 0 5 0 0 0 1\n");
  EXPECT_EQ(x_of(open({.poses = PoseFile{tum}, .pose_frame = PoseFrame::kCamera}), 0), 5.0);
  std::filesystem::remove(folder_ / "calib.txt");
  EXPECT_THAT(message_of<DataError>([&] { open({.pose_frame = PoseFrame::kCamera}); }),
              HasSubstr("calib.txt: does not exist"));
}

TEST_F(PoseSources, RefuseAnotherNumberOfRows) {
  const auto poses = folder_.write("p.csv", "1,0,0,0,0,0,1\n");
  EXPECT_THAT(message_of<DataError>([&] { open({.poses = PoseFile{poses}}); }),
              HasSubstr("1 pose rows for 3 scans"));
}

}  // namespace
}  // namespace mosbench
