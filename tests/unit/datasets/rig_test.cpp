#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "datasets/formats/mounts_file.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/perturb/perturbation.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/kept_scans.hpp"
#include "datasets/text/errors.hpp"
#include "tests/rig_drive.hpp"

/// Several LiDARs that are read as one.
namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// How far a position is from the nearest wall of the street.
double from_wall_m(const Eigen::Vector3d& p) {
  double least_m = 1e9;
  for (const SceneBox& box : street()) {
    const Eigen::Array3d out = (box.low - p).cwiseMax(p - box.high).array();
    const double inside_m = out.maxCoeff();
    least_m = std::min(least_m, inside_m < 0 ? -inside_m : out.max(0.0).matrix().norm());
  }
  return least_m;
}

class Rig : public testing::Test {
 protected:
  Dataset opened(const Reading& reading, const char* name = "drive.bag") const {
    return open_dataset(folder_ / name, {.reading = reading});
  }
  std::string error_of(const Reading& reading, const char* name = "drive.bag") const {
    return message_of<std::runtime_error>([&] { opened(reading, name); });
  }
  void write_bag(const RigDrive& drive, std::size_t mounted = 2) const {
    folder_.write("drive.bag", drive.bag(mounted));
  }

  /// Points of what stands lie on its walls, and rays start at their LiDAR.
  static void expect_right(const Sequence& rig, const RigDrive& drive, double limit_m = 1e-3) {
    ASSERT_EQ(rig.size(), drive.scans);
    for (std::size_t k = 0; k < rig.size(); ++k) {
      const Frame frame = rig.read(k);
      const auto a = drive.scan(0, k), b = drive.scan(1, k);
      ASSERT_EQ(frame.points.size(), a.labels.size() + b.labels.size());
      ASSERT_EQ(frame.points.size(), rig.point_count(k));
      ASSERT_TRUE(frame.truth.has_value());
      std::vector<std::uint32_t> labels = a.labels;
      labels.insert(labels.end(), b.labels.begin(), b.labels.end());
      EXPECT_EQ(*frame.truth, labels);
      EXPECT_EQ(rig.read_truth(k), labels);
      EXPECT_EQ(frame.stamp_ns.value() - rig.stamp_ns(0).value(), a.stamp_ns - drive.ns_of(0));
      double worst_m = 0;
      for (std::size_t i = 0; i < labels.size(); ++i) {
        EXPECT_EQ(frame.origins.of_point[i], i < a.labels.size() ? 0 : 1);
        const Point& p = frame.points[i];
        const Eigen::Vector3d at = frame.map_from_sensor * Eigen::Vector3d(p.x, p.y, p.z);
        if (labels[i] == 9) worst_m = std::max(worst_m, from_wall_m(at));
      }
      EXPECT_LT(worst_m, limit_m) << "scan " << k;
      ASSERT_EQ(frame.origins.positions_m.size(), 2U);
      EXPECT_TRUE(frame.origins.positions_m[0].isZero());
      const Eigen::Vector3d own = frame.map_from_sensor * frame.origins.positions_m[1];
      const Pose expected = drive.pose_of(1, drive.seconds(1, k));
      EXPECT_LT((own - expected.translation()).norm(), limit_m);
    }
  }

  TempFolder folder_;
};

TEST_F(Rig, MergesScansByMountsAndByThePosesBetweenTheirStamps) {
  for (const bool timed : {false, true}) {
    const RigDrive drive{.timed = timed};
    write_bag(drive);
    const Dataset data = opened({.lidars = "/a,/b"});
    const Sequence& rig = *data.sequences.front();
    expect_right(rig, drive);
    EXPECT_THAT(rig.recording().doubts, IsEmpty());
    EXPECT_EQ(rig.reading().lidars,
              "/a, /b mounted at (-2.000, 0.000, 0.000) m, turned by 85.9 degrees");
    EXPECT_THAT(rig.remarks(),
                Contains(AllOf(HasSubstr("LiDARs merged: /a, /b mounted at (-2.000, "),
                               HasSubstr("degrees; rays start at each point's own"))));
    const Dataset alone = opened({.lidars = "/a"});
    const Frame merged = rig.read(3), one = alone.sequences.front()->read(3);
    EXPECT_TRUE(one.origins.empty());
    if (timed) continue;
    EXPECT_TRUE(std::equal(
        one.points.begin(), one.points.end(), merged.points.begin(),
        [](const Point& x, const Point& y) { return x.x == y.x && x.y == y.y && x.z == y.z; }));
  }
}

TEST_F(Rig, MovesScansOfAnotherStampAlsoWherePointsAreNotUndistorted) {
  const RigDrive drive;
  write_bag(drive);
  expect_right(*opened({.lidars = "/a,/b", .deskew = Deskew::kNone}).sequences.front(), drive);
  expect_right(*opened({.lidars = "/a,/b", .deskew = Deskew::kVelocity}).sequences.front(), drive);
}

TEST_F(Rig, TakesMountsThatTfRepeats) {
  const RigDrive drive{.scans = 4, .has_tf_static = false};
  write_bag(drive);
  expect_right(*opened({.lidars = "/a,/b"}).sequences.front(), drive);
}

TEST_F(Rig, MovesScansByPosesThatAreFoundLater) {
  const RigDrive drive{.timed = true};
  write_bag(drive);
  Dataset data = opened({.poses = ByOdometry{}, .lidars = "/a,/b"});
  PosedSequence posed(std::move(data.sequences.front()), {});
  EXPECT_EQ(posed.read(1).origins.positions_m.size(), 2U) << "before poses are known";
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < drive.scans; ++k)
    poses.push_back(drive.pose_of(0, drive.seconds(0, k)));
  posed.set_poses(poses);
  expect_right(posed, drive);
}

TEST_F(Rig, KeepsOriginsOfScansThatAreKept) {
  write_bag({.scans = 3});
  Dataset data = opened({.lidars = "/a,/b"});
  const KeptSequence kept(std::move(data.sequences.front()),
                          std::make_shared<KeptScans>(std::size_t{1} << 26));
  const Frame first = kept.read(1), again = kept.read(1);
  EXPECT_FALSE(first.origins.empty());
  EXPECT_EQ(first.origins.of_point, again.origins.of_point);
  EXPECT_EQ(first.origins.positions_m, again.origins.positions_m);
}

TEST_F(Rig, IsDisturbedAlongTheRaysOfEachLidar) {
  const RigDrive drive{.scans = 3};
  write_bag(drive);
  const Frame plain = opened({.lidars = "/a,/b"}).sequences.front()->read(1);
  const Frame longer =
      opened({.lidars = "/a,/b", .perturb = parse_perturbation("range_bias_m=0.5")})
          .sequences.front()
          ->read(1);
  for (std::size_t i = 0; i < plain.points.size(); ++i) {
    const Eigen::Vector3d ray = position_of(plain.points[i]) - plain.origins.at(i);
    const Eigen::Vector3d expected = ray * (1 + 0.5 / ray.norm()) + plain.origins.at(i);
    ASSERT_LT((position_of(longer.points[i]) - expected).norm(), 1e-4) << i;
  }
}

TEST_F(Rig, TakesTheNearestScanAndCountsThoseWithout) {
  const RigDrive drive{.scans = 6, .later_s = 0.08};
  write_bag(drive);
  const Dataset data = opened({.lidars = "/a,/b"});
  const Sequence& rig = *data.sequences.front();
  EXPECT_THAT(rig.remarks(), Contains("/b: 1 of 6 scans have no scan of it within 50 ms"));
  EXPECT_THAT(rig.remarks(),
              Contains("/b: 1 of its 6 scans are left out: no scan of /a is nearest"));
  EXPECT_EQ(rig.point_count(0), drive.scan(0, 0).labels.size());
  EXPECT_EQ(rig.read(0).points.size(), rig.point_count(0));
  for (std::size_t k = 1; k < 6; ++k) {
    EXPECT_EQ(rig.read(k).points.size(),
              drive.scan(0, k).labels.size() + drive.scan(1, k - 1).labels.size());
  }
}

TEST_F(Rig, TakesNoScanTwice) {
  const auto left_out_of = [&](double later_s) {
    write_bag({.scans = 6, .later_s = later_s});
    const Dataset data = opened({.lidars = "/a,/b"});
    std::size_t alone = 0;
    const RigDrive drive{.scans = 6, .later_s = later_s};
    for (std::size_t k = 0; k < 6; ++k) {
      alone += data.sequences.front()->point_count(k) == drive.scan(0, k).labels.size() ? 1U : 0U;
    }
    return alone;
  };
  EXPECT_EQ(left_out_of(0.05), 0U) << "exactly between two scans";
  EXPECT_EQ(left_out_of(-0.05), 1U);
}

TEST_F(Rig, GivesAScanBetweenTwoToTheNearer) {
  const RigDrive drive{.scans = 6};
  drive.write_folders(folder_, "rig");
  folder_.write("rig/a/times.txt", "5.00\n5.08\n5.20\n5.30\n5.40\n5.50\n");
  folder_.write("rig/b/times.txt", "5.041\n5.20\n5.30\n5.40\n5.50\n5.60\n");
  const Dataset data = opened({.lidars = "a,b"}, "rig");
  const Sequence& rig = *data.sequences.front();
  EXPECT_EQ(rig.point_count(0), drive.scan(0, 0).labels.size());
  EXPECT_EQ(rig.point_count(1), drive.scan(0, 1).labels.size() + drive.scan(1, 0).labels.size());
  EXPECT_THAT(rig.remarks(), Contains("b: 1 of 6 scans have no scan of it within 50 ms"));
}

TEST_F(Rig, RefusesLidarsWithoutMountOrWithAnotherClock) {
  write_bag({.scans = 3}, 1);
  EXPECT_THAT(
      error_of({.lidars = "/a,/b"}),
      HasSubstr("no transform that never changes leads from lidar_b to lidar_a (base, lidar_a), "
                "expected the mounts of both in /tf_static, or one LiDAR in lidars"));
  write_bag({.scans = 3, .later_s = 100});
  EXPECT_THAT(
      error_of({.poses = StaticPoses{}, .lidars = "/a,/b"}),
      HasSubstr("no scan of /b is within 50 ms of one of /a: they are from 1100.000 to "
                "1100.200 s, and from 1000.000 to 1000.200 s, expected clocks of one time"));
}

/// LiDARs that are where the first is.
void expect_one_origin(const Sequence& rig) {
  EXPECT_THAT(rig.recording().doubts,
              Contains(HasSubstr("rays start at the origin of that, not at the LiDARs")));
  EXPECT_THAT(rig.remarks(), Not(Contains(HasSubstr("rays start at each point's own"))));
}

TEST_F(Rig, DoubtsOriginsOfScansInOneFrameAndOfEqualMounts) {
  write_bag({.scans = 3, .frames = {"lidar", "lidar"}});
  expect_one_origin(*opened({.lidars = "/a,/b"}).sequences.front());
  RigDrive{.scans = 3}.write_folders(folder_, "rig");
  folder_.write("rig/mounts.txt", "a 1 0 0 0 0 0 1\nb 1 0 0 0 0 1 0\n");
  expect_one_origin(*opened({.lidars = "a,b"}, "rig").sequences.front());
}

TEST_F(Rig, DoubtsLidarsThatAreFarAway) {
  RigDrive{.scans = 3}.write_folders(folder_, "rig");
  folder_.write("rig/mounts.txt", "a 1000 0 0 0 0 0 1\nb -1000 0 0 0 0 0 1\n");
  EXPECT_THAT(opened({.lidars = "a,b"}, "rig").sequences.front()->recording().doubts,
              Contains("b is mounted 2000.0 m from a, expected at most 20"));
}

TEST_F(Rig, KeepsMarksAndRemarksOfAllLidars) {
  RigDrive{.scans = 3}.write_folders(folder_, "rig");
  folder_.write("rig/a/disturbed.txt", "disturbed: range_noise_m=0.05\n");
  folder_.write("rig/b/simulated.json",
                format_simulated_origin({"recording", "town", "1234", 3, 7, "dropout=0.5"}));
  std::filesystem::remove_all(folder_ / "rig/b/labels");
  const Dataset data = opened({.lidars = "a,b"}, "rig");
  const Sequence& rig = *data.sequences.front();
  ASSERT_TRUE(rig.simulated());
  EXPECT_EQ(rig.simulated()->scene, "town");
  EXPECT_EQ(rig.mark().disturbed, "range_noise_m=0.05 and dropout=0.5");
  EXPECT_EQ(rig.simulated()->perturb, rig.mark().disturbed);
  EXPECT_THAT(rig.remarks(), Contains("b: no labels/: there is no truth"));
  const auto one = opened({.poses = StaticPoses{}, .lidars = "b"}, "rig");
  EXPECT_EQ(one.sequences.front()->mark().disturbed, "dropout=0.5");
}

TEST_F(Rig, DoubtsLidarsOfWhichLittleIsMerged) {
  const RigDrive drive{.scans = 6};
  drive.write_folders(folder_, "rig");
  folder_.write("rig/b/times.txt", "5.00\n5.10\n15.20\n15.30\n15.40\n15.50\n");
  for (std::size_t k = 0; k < 6; ++k) {
    folder_.write(fmt::format("rig/b/{:06}.bin", k), "");
    folder_.write(fmt::format("rig/b/labels/{:06}.label", k), "");
  }
  EXPECT_THAT(opened({.lidars = "a,b"}, "rig").sequences.front()->recording().doubts,
              AllOf(Contains("b: 4 of 6 scans have no scan of it within 50 ms"),
                    Contains("b: all its scans are empty")));
}

TEST(LidarNames, AreTakenWholeHoweverLong) {
  const std::string a = "/ouster/points", b = "/livox_front_left/lidar/points_with_times";
  EXPECT_EQ(lidar_names({.lidars = a + ", " + b + ",c"}), (std::vector<std::string>{a, b, "c"}));
}

TEST_F(Rig, ReadsOneLidarByName) {
  write_bag({.scans = 3});
  EXPECT_THAT(error_of({}), HasSubstr("holds several PointCloud2 topics: /a, /b, expected one of "
                                      "them, topic /a, or two to six of a rig, which are merged: "
                                      "lidars /a,/b"));
  const Frame named = opened({.lidars = "/b"}).sequences.front()->read(1);
  const Frame topic = opened({.topic = "/b"}).sequences.front()->read(1);
  ASSERT_EQ(named.points.size(), topic.points.size());
  EXPECT_EQ(named.map_from_sensor.matrix(), topic.map_from_sensor.matrix());
  EXPECT_TRUE(named.origins.empty());
}

TEST_F(Rig, RefusesNamesThatAreNoRig) {
  write_bag({.scans = 3});
  for (const char* wrong : {"", "/a,", "/a,/a", "1,2,3,4,5,6,7"}) {
    EXPECT_THAT(error_of({.lidars = wrong}), HasSubstr("one to six LiDARs, each once")) << wrong;
  }
  EXPECT_THAT(error_of({.lidars = "/a,/c"}), HasSubstr("has no PointCloud2 topic /c"));
  EXPECT_THAT(error_of({.topic = "/a", .lidars = "/b"}), HasSubstr("expected one of both"));
  EXPECT_THAT(error_of({.lidars = "/a,/b", .point_times = PointTimes::kAzimuth}),
              HasSubstr("are those of one, expected one"));
  EXPECT_THAT(message_of<UsageError>([&] {
                open_dataset(folder_ / "drive.bag",
                             {.kind = DatasetKind::kDoals, .reading = {.lidars = "/a"}});
              }),
              HasSubstr("is for recordings of your own"));
}

TEST_F(Rig, MergesFoldersBesideTheirMounts) {
  const RigDrive drive;
  drive.write_folders(folder_, "rig");
  const Dataset data = opened({.lidars = "a,b"}, "rig");
  EXPECT_EQ(data.kind, DatasetKind::kRecording);
  EXPECT_EQ(data.sequences.front()->name(), "rig");
  expect_right(*data.sequences.front(), drive);
  EXPECT_THAT(data.sequences.front()->files(), Contains(folder_ / "rig/mounts.txt"));
  EXPECT_THAT(data.sequences.front()->files(), Contains(folder_ / "rig/b/000003.bin"));
  EXPECT_EQ(opened({.lidars = "a"}, "rig").sequences.front()->read(0).points.size(),
            drive.scan(0, 0).labels.size());

  EXPECT_THAT(error_of({.lidars = "a,c"}, "rig"), HasSubstr("rig/c: is no folder"));
  std::filesystem::create_directory(folder_ / "rig/c");
  EXPECT_THAT(error_of({.lidars = "a,c"}, "rig"),
              HasSubstr("mounts.txt: has no row of c, expected one for each LiDAR: name tx"));
  std::filesystem::rename(folder_ / "rig/a/poses.txt", folder_ / "rig/poses.txt");
  expect_right(*opened({.lidars = "a,b"}, "rig").sequences.front(), drive);
  std::filesystem::remove(folder_ / "rig/b/times.txt");
  EXPECT_THAT(error_of({.lidars = "a,b"}, "rig"), HasSubstr("the scans of b have no stamps"));
  std::filesystem::remove(folder_ / "rig/mounts.txt");
  EXPECT_THAT(error_of({.lidars = "a,b"}, "rig"), HasSubstr("mounts.txt"));
}

TEST_F(Rig, HasTruthWhereAllOfItsScansHave) {
  const RigDrive drive{.scans = 4};
  drive.write_folders(folder_, "rig");
  std::filesystem::remove(folder_ / "rig/b/labels/000002.label");
  const Dataset data = opened({.lidars = "a,b"}, "rig");
  const Sequence& rig = *data.sequences.front();
  EXPECT_TRUE(rig.has_truth(1) && rig.read(1).truth);
  EXPECT_FALSE(rig.has_truth(2) || rig.read(2).truth);
}

TEST(Mounts, AreOneRowForEachLidar) {
  const auto mounts = parse_mounts("top 1 2 3 0 0 0 1\nside -1 0 0 0 0 1 0\n", "m");
  EXPECT_EQ(mounts.at("top").translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(mounts.at("side").linear()(0, 0), -1, 1e-12);
  const char* commented =
      "# vehicle_from_lidar\n\n top 1 2 3 0 0 0 1 # metres\r\n\nb 0 0 0 0 0 0 1";
  EXPECT_EQ(parse_mounts(commented, "m").size(), 2U);
  EXPECT_THAT(message_of<DataError>([] { parse_mounts("#\n\ntop 1\n", "m"); }),
              HasSubstr("m:3: 2 words in the row, expected name tx ty tz qx qy qz qw of "
                        "vehicle_from_lidar, metres"));
  for (const auto& [text, wrong] : {std::pair{"top 1 2 3 0 0 0\n", "m:1: 7 words in the row"},
                                    {"top 1 2 3 0 0 0 1\ntop 1 2 3 0 0 0 1\n", "m:2: a second row"},
                                    {"top 1 2 x 0 0 0 1\n", "m:1: \"x\" is no finite number"},
                                    {"top 1 2 3 0 0 0 2\n", "m:1: the quaternion"}}) {
    EXPECT_THAT(message_of<DataError>([text = text] { parse_mounts(text, "m"); }),
                HasSubstr(wrong));
  }
}

}  // namespace
}  // namespace mosbench
