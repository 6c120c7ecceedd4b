#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "datasets/sequence/pose_track.hpp"
#include "tests/unit/datasets/drive_bags.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

INSTANTIATE_TEST_SUITE_P(Of, BagPoses,
                         testing::Values(DriveBag::kRos1, DriveBag::kMcap,
                                         DriveBag::kMcapWithoutChunks, DriveBag::kDb3));

TEST_P(BagPoses, OfRowsBelongToTheirScansWhateverTheStamps) {
  const std::vector<std::vector<double>> stamps = {{5, 5, 5, 5}, {0, 0, 0, 1}, {0, 1, 1, 2},
                                                   {0, 1, 2, 2}, {3, 2, 1, 0}, {0, 2, 1, 3}};
  std::string rows;
  for (int k = 0; k < 4; ++k) rows += "1 0 0 " + std::to_string(k) + " 0 1 0 0 0 0 1 0\n";
  const auto file = folder_.write("rows.txt", rows);
  for (const std::vector<double>& of_scans : stamps) {
    Drive drive;
    // The recorder's times are in order.
    for (std::size_t k = 0; k < of_scans.size(); ++k) {
      add_cloud(drive, at(of_scans[k]));
      drive.back().recorded_ns = at(static_cast<double>(k));
    }
    const BagSequence sequence = open(drive, {.poses = PoseFile{file}});
    EXPECT_THAT(xs_of(sequence), testing::ElementsAre(0.0, 1.0, 2.0, 3.0));
    EXPECT_THAT(sequence.recording().doubts,
                Contains(HasSubstr("are not later than the one before")));
  }
}

TEST_P(BagPoses, OfOdometryAreTakenWhereTheTransformsAreAMount) {
  for (const char* topic : {"/tf", "/tf_static"}) {
    for (const bool turns : {false, true}) {
      const Drive drive = drive_of([&](Drive& to, std::int64_t stamp_ns, double k) {
        Pose mount = pose_at_x(10.0);
        if (turns && topic == std::string("/tf")) {
          mount.rotate(Eigen::AngleAxisd(0.1 * k, Eigen::Vector3d::UnitZ()));
        }
        add_tf(to, {stamp_ns, "base", "lidar", mount}, topic);
        add_pose(to, kOdometry, stamp_ns, k);
      });
      for (const Reading& asked :
           {Reading{}, Reading{.map_frame = "odom"}, Reading{.pose_topic = "/pose"}}) {
        const BagSequence sequence = open(drive, asked);
        ASSERT_EQ(sequence.size(), 12U);
        EXPECT_EQ(xs_of(sequence).back(), 21.0);
        EXPECT_THAT(sequence.reading().poses.source,
                    AllOf(HasSubstr("/pose"), HasSubstr("odom from lidar")));
      }
    }
  }
}

TEST_P(BagPoses, OfTransformsAreTakenWhereTheyMoveOrNothingElseIsThere) {
  const Drive moving = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(k)});
    add_pose(to, kOdometry, stamp_ns, 100 * k, "lidar");
  });
  EXPECT_EQ(xs_of(open(moving)).back(), 11.0);
  const Drive standing = drive_of([](Drive& to, std::int64_t stamp_ns, double) {
    add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(4.0)});
  });
  EXPECT_THAT(xs_of(open(standing)), Each(4.0));
}

TEST_P(BagPoses, WithoutAFrameAreTheSensorsUnlessTheUserSaysWhose) {
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_tf(to, {stamp_ns, "base", "lidar", pose_at_x(10.0)});
    add_pose(to, kPoseStamped, stamp_ns, k);
  });
  const BagSequence sequence = open(drive);
  EXPECT_EQ(xs_of(sequence).back(), 11.0);
  EXPECT_THAT(sequence.recording().doubts, Contains(HasSubstr("ask for pose_topic /pose@base")));
  EXPECT_EQ(xs_of(open(drive, {.pose_topic = "/pose@base"})).back(), 21.0);
}

TEST_P(BagPoses, OfWhichNoneNamesAMapAreTaken) {
  for (const std::string_view type : {kOdometry, kPoseStamped, kPoseWithCovarianceStamped}) {
    for (const std::string child : {"", "lidar"}) {
      const Drive drive = drive_of([&](Drive& to, std::int64_t stamp_ns, double k) {
        add_pose(to, type, stamp_ns, k, child, 1.0, "");
      });
      EXPECT_EQ(xs_of(open(drive)).back(), 11.0) << type;
      EXPECT_EQ(xs_of(open(drive, {.map_frame = "world"})).back(), 11.0) << type;
    }
    const Drive later = drive_of([&](Drive& to, std::int64_t stamp_ns, double k) {
      add_pose(to, type, stamp_ns, k < 1 ? 99.0 : k, "lidar", 1.0, k < 1 ? "" : "odom");
    });
    const BagSequence sequence = open(later);
    EXPECT_EQ(xs_of(sequence).front(), 1.0) << "that of the start is ignored";
    EXPECT_THAT(sequence.remarks(), Contains(HasSubstr("1 transform of no frame is ignored")));
  }
}

TEST_P(BagPoses, InHolesAreNotInvented) {
  for (const int first : {1, 4, 9}) {
    const auto holed = [&](const std::function<void(Drive&, std::int64_t, double)>& make) {
      return drive_of([&](Drive& to, std::int64_t stamp_ns, double k) {
        if (k < first || k >= first + 2) make(to, stamp_ns, k);
      });
    };
    const std::vector<Drive> drives = {holed([](Drive& to, std::int64_t stamp_ns, double k) {
                                         add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(k)});
                                       }),
                                       holed([](Drive& to, std::int64_t stamp_ns, double k) {
                                         add_pose(to, kOdometry, stamp_ns, k, "lidar");
                                       }),
                                       holed([](Drive& to, std::int64_t stamp_ns, double k) {
                                         add_pose(to, kPoseStamped, stamp_ns, k);
                                       })};
    for (const Drive& drive : drives) {
      EXPECT_EQ(open(drive).size(), 12U) << "0.3 s are no hole";
      const BagSequence sequence = open(drive, {.max_pose_gap_s = 0.2});
      EXPECT_EQ(sequence.size(), 10U);
      EXPECT_THAT(xs_of(sequence), Not(Contains(static_cast<double>(first))));
      EXPECT_THAT(sequence.recording().doubts,
                  Contains(AllOf(HasSubstr("2 of 12 scans are left out"),
                                 HasSubstr("holes of more than 0.2 s"))));
    }
  }
}

TEST_P(BagPoses, ThatAreRareButHardlyChangeMakeNoHoles) {
  Drive drive;
  for (int k = 0; k < 20; ++k) {
    add_cloud(drive, at(k));
    add_tf(drive, {at(k), "odom", "lidar", pose_at_x(k)});
    // Once a second the map is corrected by 5 cm; the mount is told again as it was.
    if (k % 10 == 0 || k == 19) add_tf(drive, {at(k), "map", "odom", pose_at_x(0.005 * k)});
    if (k % 19 == 0) add_tf(drive, {at(k), "earth", "map", pose_at_x(100.0)});
  }
  const BagSequence sequence = open(drive, {.map_frame = "earth"});
  EXPECT_EQ(sequence.size(), 20U);
  EXPECT_NEAR(xs_of(sequence).back(), 119.095, 1e-9);
}

TEST_P(BagPoses, OfFramesThatAreNotAskedForAreNotJudged) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto zero = [](Drive& to, std::int64_t stamp_ns, const char* parent, const char* child) {
    StampedTransform transform{stamp_ns, parent, child, Pose::Identity()};
    transform.parent_from_child.linear().setZero();
    add_tf(to, transform);
  };
  const std::vector<std::function<void(Drive&, std::int64_t)>> foreign = {
      [](Drive& to, std::int64_t stamp_ns) {
        add_tf(to, {stamp_ns, "lidar", "camera", Pose::Identity()});
        add_tf(to, {stamp_ns, "base", "camera", Pose::Identity()});
      },
      [&](Drive& to, std::int64_t stamp_ns) { zero(to, stamp_ns, "map", "gps"); },
      [&](Drive& to, std::int64_t stamp_ns) {
        add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(nan)});
      },
      [&](Drive& to, std::int64_t stamp_ns) {
        add_tf(to, {stamp_ns, "", "lidar", pose_at_x(99.0)});
        add_tf(to, {stamp_ns, "map", "", pose_at_x(99.0)});
        add_tf(to, {stamp_ns, "lidar", "lidar", pose_at_x(99.0)});
      }};
  for (const auto& add : foreign) {
    for (const int where : {0, 5, 11}) {
      const Drive drive = drive_of([&](Drive& to, std::int64_t stamp_ns, double k) {
        if (static_cast<int>(k) == where) add(to, stamp_ns);
        add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(k)});
      });
      const BagSequence sequence = open(drive);
      EXPECT_EQ(sequence.size(), 12U);
      EXPECT_EQ(xs_of(sequence).back(), 11.0);
      const bool is_camera = &add == &foreign.front();
      const auto has_word = Contains(HasSubstr("ignored, as tf2 does"));
      EXPECT_EQ(testing::Value(sequence.remarks(), has_word), !is_camera);
    }
  }
}

TEST_P(BagPoses, ThatAreZeroAtFirstAreIgnoredAndCounted) {
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_pose(to, kOdometry, stamp_ns, k < 2 ? 0.0 : k, "lidar", k < 2 ? 0.0 : 1.0);
  });
  const BagSequence sequence = open(drive);
  EXPECT_EQ(sequence.size(), 10U);
  EXPECT_THAT(sequence.remarks(),
              Contains(HasSubstr("2 transforms of lidar are ignored, as tf2 does")));
  EXPECT_THAT(sequence.recording().doubts, Contains(HasSubstr("2 of 12 scans are left out")));
}

TEST_P(BagPoses, AskWhichOfTwoParentsIsMeant) {
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_tf(to, {stamp_ns, "odom", "lidar", pose_at_x(k)});
    add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(2 * k)});
  });
  EXPECT_THAT(error_of(drive),
              AllOf(HasSubstr("frame lidar has the parents map and odom"), HasSubstr("map_frame")));
  EXPECT_EQ(xs_of(open(drive, {.map_frame = "map"})).back(), 22.0);
  EXPECT_EQ(xs_of(open(drive, {.map_frame = "odom"})).back(), 11.0);
}

TEST_P(BagPoses, OfTwoPublishersAreDoubted) {
  const auto drive_apart = [](double apart_m, double noise_m) {
    return drive_of([=](Drive& to, std::int64_t stamp_ns, double k) {
      const double off_m = static_cast<int>(k) % 3 == 0 ? noise_m : 0.0;
      add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(k + off_m)});
      add_tf(to, {stamp_ns + kStep_ns / 2, "map", "lidar", pose_at_x(k + 0.5 + apart_m)});
    });
  };
  EXPECT_THAT(open(drive_apart(0.8, 0.0)).recording().doubts,
              Contains(HasSubstr("map from lidar is told in two ways that are 0.80 m apart")));
  for (const double noise_m : {0.0, 0.3}) {
    EXPECT_THAT(open(drive_apart(0.0, noise_m)).recording().doubts, testing::IsEmpty());
  }
}

TEST_P(BagPoses, OfTwoMountsAreThoseOfTheLast) {
  Drive drive;
  add_tf(drive, {at(0), "base", "lidar", pose_at_x(0.0)}, "/tf_static");
  for (int k = 0; k < 12; ++k) {
    add_cloud(drive, at(k));
    add_tf(drive, {at(k), "map", "base", pose_at_x(k)});
  }
  add_tf(drive, {at(12), "base", "lidar", pose_at_x(2.0)}, "/tf_static");
  const BagSequence sequence = open(drive);
  EXPECT_EQ(xs_of(sequence).back(), 13.0);
  EXPECT_THAT(
      sequence.recording().doubts,
      Contains(HasSubstr("base from lidar is told in two ways that are 2.00 m apart: the last")));
}

TEST_P(BagPoses, OfTheParentThatMovesAreTaken) {
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_tf(to, {stamp_ns, "a_camera", "lidar", pose_at_x(5.0)});
    add_tf(to, {stamp_ns, "base", "lidar", pose_at_x(1.0)});
    add_tf(to, {stamp_ns, "odom", "base", pose_at_x(k)});
  });
  EXPECT_EQ(xs_of(open(drive)).back(), 12.0);
}

TEST_P(BagPoses, NeedScansThatNameAFrame) {
  Drive drive;
  for (int k = 0; k < 12; ++k) {
    add_cloud(drive, at(k), "");
    add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
  }
  EXPECT_THAT(error_of(drive), AllOf(HasSubstr("the scans name no frame"), HasSubstr("/tf: lidar, "
                                                                                     "map")));
}

TEST_P(BagPoses, OfOdometryOfAnotherFrameAreOffered) {
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_pose(to, kOdometry, stamp_ns, k, "body");
    add_tf(to, {stamp_ns, "base", "lidar", pose_at_x(1.0)});
  });
  const char* offer = "pose_topic /pose@lidar";
  EXPECT_THAT(open(drive).recording().doubts, Contains(HasSubstr(offer)));
  EXPECT_THAT(open(drive, {.pose_topic = "/pose@lidar"}).recording().doubts, testing::IsEmpty());
  const Drive without = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_pose(to, kOdometry, stamp_ns, k, "body");
  });
  EXPECT_THAT(error_of(without), HasSubstr(offer));
}

TEST_P(BagPoses, NameTheTransformThatDoesNotCoverTheScans) {
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    if (k == 0) add_tf(to, {stamp_ns - 1, "map", "odom", Pose::Identity()});
    add_tf(to, {stamp_ns, "odom", "lidar", pose_at_x(k)});
  });
  EXPECT_THAT(error_of(drive), AllOf(HasSubstr("transforms cover 0 of 12 scans"),
                                     HasSubstr("map from odom is known at 1700000000.000 s alone"),
                                     HasSubstr("another frame in map_frame")));
  EXPECT_EQ(open(drive, {.map_frame = "odom"}).size(), 12U);
}

TEST_P(BagPoses, AreTakenForScansThatNameAFrame) {
  for (const int where : {0, 6, 11}) {
    Drive drive;
    for (int k = 0; k < 12; ++k) {
      add_cloud(drive, at(k), k == where ? "" : "lidar");
      add_tf(drive, {at(k), "map", "lidar", pose_at_x(k)});
    }
    const BagSequence sequence = open(drive);
    EXPECT_EQ(sequence.size(), 11U);
    EXPECT_THAT(xs_of(sequence), Not(Contains(static_cast<double>(where))));
    EXPECT_THAT(sequence.recording().doubts,
                Contains("1 of 12 scans are left out: they name no frame"));
  }
}

TEST_P(BagPoses, AreReadFromMessagesThatArePackedOneByOne) {
  if (GetParam() == DriveBag::kRos1) GTEST_SKIP() << "ROS 1 packs no single messages";
  const Drive drive = drive_of([](Drive& to, std::int64_t stamp_ns, double k) {
    add_tf(to, {stamp_ns, "map", "lidar", pose_at_x(k)});
  });
  const std::vector<double> plain = xs_of(open(drive));
  packs_messages_ = true;
  EXPECT_EQ(xs_of(open(drive)), plain);
}

TEST(ScanTracks, GiveEveryScanItsOwnPose) {
  for (std::uint32_t seed = 1; seed < 200; ++seed) {
    std::vector<std::pair<std::int64_t, Pose>> scans;
    std::uint32_t state = seed;
    for (int k = 0; k < 12; ++k) {
      state = state * 1664525U + 1013904223U;
      scans.emplace_back(static_cast<int>((state >> 24U) % 6) + 2 * k, pose_at_x(k));
    }
    const ScanTracks tracks(scans);
    for (std::size_t k = 0; k < scans.size(); ++k) {
      EXPECT_EQ(tracks.around(k).at(scans[k].first)->translation().x(), static_cast<double>(k));
    }
  }
}

}  // namespace
}  // namespace mosbench
