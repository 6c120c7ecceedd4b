#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/formats/tracklets.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kPacketRest = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

std::string oxts_error(const std::string& text) {
  return message_of<DataError>([&] { parse_oxts(text, "o.txt"); });
}

TEST(KittiOxts, ProjectsWithTheScaleOfTheFirstLatitude) {
  constexpr double kRadius_m = 6378137.0, kDeg = std::numbers::pi / 180.0;
  const auto packets =
      parse_oxts("49 8 100 0 0 0" + kPacketRest + "49.001 8.002 103 0 0 0" + kPacketRest, "o");
  const auto poses = poses_of_oxts(packets);
  const double scale = std::cos(49 * kDeg);
  EXPECT_EQ(poses[0].matrix(), Pose::Identity().matrix());
  EXPECT_NEAR(poses[1].translation().x(), scale * kRadius_m * 0.002 * kDeg, 1e-6);
  // A minute piece of the meridian: Mercator stretches it by 1/cos(latitude), which scale undoes.
  EXPECT_NEAR(poses[1].translation().y(), kRadius_m * 0.001 * kDeg, 2e-3);
  EXPECT_NEAR(poses[1].translation().z(), 3.0, 1e-12);
}

TEST(KittiOxts, SeesPosesFromTheFirstAttitude) {
  const double north = std::numbers::pi / 2;
  const auto packets =
      parse_oxts(fmt::format("49 8 0 0 0 {}", north) + kPacketRest +
                     fmt::format("49.001 8 0 0.1 0.2 {}", north + 0.3) + kPacketRest,
                 "o");
  const Pose pose = poses_of_oxts(packets)[1];
  EXPECT_NEAR(pose.translation().x(), 111.32, 0.01) << "driven north, which is ahead";
  EXPECT_NEAR(pose.translation().y(), 0.0, 1e-6);
  const Eigen::Matrix3d expected = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) *
                                    Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
                                       .toRotationMatrix();
  EXPECT_LT((pose.linear() - expected).norm(), 1e-12);
}

TEST(KittiOxts, GivesPosesBackAsPackets) {
  std::vector<Pose> poses = {Pose::Identity()};
  for (int i = 1; i < 40; ++i) {
    Pose& pose = poses.emplace_back(Pose::Identity());
    pose.translation() << 31.7 * i, -100.0 + 7.1 * i * i, 0.3 * i;
    pose.linear() = (Eigen::AngleAxisd(0.17 * i, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(0.03 * i, Eigen::Vector3d(1, 2, 0).normalized()))
                        .toRotationMatrix();
  }
  const auto again = poses_of_oxts(parse_oxts(format_oxts(oxts_of_poses(poses)), "o"));
  ASSERT_EQ(again.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((again[i].matrix() - poses[i].matrix()).cwiseAbs().maxCoeff(), 1e-6) << i;
  }
}

/// Seen from a camera's frame, whose z is ahead, the x of a LiDAR points along z.
TEST(KittiOxts, GivesPosesBackThatPointStraightUp) {
  std::vector<Pose> poses(3, Pose::Identity());
  poses[1].linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  poses[2].linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const auto again = poses_of_oxts(oxts_of_poses(poses));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((again[i].matrix() - poses[i].matrix()).cwiseAbs().maxCoeff(), 1e-12) << i;
  }
}

TEST(KittiOxts, RefusesWhatIsNoPacket) {
  EXPECT_THAT(oxts_error("49 8 1 0 0 0\n"), HasSubstr("o.txt:1: has 6 numbers, expected the 30"));
  EXPECT_THAT(oxts_error("49 8 1 0 0 0" + kPacketRest + "49 8 x 0 0 0" + kPacketRest),
              HasSubstr("o.txt:2: \"x\" is no number"));
  EXPECT_THAT(oxts_error("90 8 1 0 0 0" + kPacketRest), HasSubstr("Mercator"));
  EXPECT_THAT(oxts_error("49 361 1 0 0 0" + kPacketRest), HasSubstr("Mercator"));
  EXPECT_THAT(oxts_error("nan 8 1 0 0 0" + kPacketRest), HasSubstr("is no number"));
}

TEST(KittiStamps, AreNanosecondsSince1970) {
  const auto stamps = parse_kitti_stamps(
      "1970-01-01 00:00:01\n\n2011-09-26 13:02:25.594360375\r\n2012-02-29 00:00:00.5\n", "t");
  EXPECT_THAT(stamps, ElementsAre(1'000'000'000, std::nullopt, 1'317'042'145'594'360'375,
                                  1'330'473'600'500'000'000));
  EXPECT_EQ(parse_kitti_stamps(format_kitti_stamps(stamps), "t"), stamps);
  EXPECT_EQ(format_kitti_stamps(stamps),
            "1970-01-01 00:00:01.000000000\n\n2011-09-26 13:02:25.594360375\n"
            "2012-02-29 00:00:00.500000000\n");
}

TEST(KittiStamps, RefuseWhatIsNoTime) {
  for (const std::string text :
       {"2011-09-26", "2011-02-29 00:00:00", "2011-13-01 00:00:00", "2011-09-26T13:02:25",
        "2011-09-26 24:00:00", "2011-09-26 13:60:00", "2011-09-26 13:02:25.", "1969-01-01 00:00:00",
        "2011-09-26 13:02:25.1234567890", "2011-09-26 13:02:25,5", "2262-01-01 00:00:00",
        "+011-09-26 13:02:25", "12345"}) {
    EXPECT_THAT(message_of<DataError>([&] { parse_kitti_stamps("\n" + text + "\n", "t"); }),
                HasSubstr("t:2: \"" + text + "\" is no time"));
  }
}

const std::string kTrackingCalib =
    "P0: 7 0 6 0 0 7 1 0 0 0 1 0\nP2: 721.5377 0 600 0 0 721.5377 170 0 0 0 1 0\n"
    "R_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam 0 -1 0 0.5 0 0 -1 -0.1 1 0 0 -0.3\n"
    "Tr_imu_velo 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.7\n";

TEST(KittiCalib, GivesTheViewOfTheCamera) {
  const KittiMounting mounting = parse_tracking_calib(kTrackingCalib, "c");
  EXPECT_EQ(mounting.view.width_px, 1242.0);
  EXPECT_EQ(mounting.view.height_px, 375.0);
  EXPECT_EQ(mounting.lidar_from_imu.translation(), Eigen::Vector3d(-0.8, 0.3, -0.7));
  const CameraView& view = mounting.view;
  const Eigen::Vector3d ahead = view.project({10.3, 0.5, -0.1});
  EXPECT_NEAR(ahead.x() / ahead.z(), 600.0, 1e-9);
  EXPECT_NEAR(ahead.y() / ahead.z(), 170.0, 1e-9);
  EXPECT_NEAR(ahead.z(), 10.0, 1e-9);
  EXPECT_TRUE(view.sees({10.3, 0.5, -0.1}));
  EXPECT_FALSE(view.sees({-10.3, 0.5, -0.1})) << "behind";
  const double left_m = 600.0 / 721.5377 * 10.0;
  EXPECT_TRUE(view.sees({10.3, 0.5 + left_m - 1e-6, -0.1}));
  EXPECT_FALSE(view.sees({10.3, 0.5 + left_m + 1e-6, -0.1}));
  const double down_m = 205.0 / 721.5377 * 10.0;
  EXPECT_TRUE(view.sees({10.3, 0.5, -0.1 - down_m + 1e-6}));
  EXPECT_FALSE(view.sees({10.3, 0.5, -0.1 - down_m - 1e-6}));
  EXPECT_FALSE(view.sees({std::nan(""), 0.5, -0.1}));
}

TEST(KittiCalib, RefusesWhatIsNoCalibration) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kTrackingCalib;
    text.replace(text.find(from), from.size(), to);
    return message_of<DataError>([&] { parse_tracking_calib(text, "c"); });
  };
  EXPECT_THAT(with("Tr_imu_velo", "Tr_imu"), HasSubstr("c: has no line \"Tr_imu_velo\""));
  EXPECT_THAT(with("R_rect 1", "R_rect 2"), HasSubstr("R_rect is no rotation"));
  EXPECT_THAT(with("R_rect 1", "R_rect"), HasSubstr("R_rect: has 8 numbers"));
  EXPECT_THAT(with("R_rect 1", "R_rect x"), HasSubstr("R_rect: \"x\" is no number"));
  EXPECT_THAT(with("P0:", "P2:"), HasSubstr("c:2: a second line \"P2\""));
  EXPECT_THAT(with("721.5377", "700"), HasSubstr("P2 has a focal length of 700 pixels"));
  EXPECT_THAT(with("721.5377", "-1"), HasSubstr("P2 is no projection"));
}

TEST(KittiCalib, IsWrittenAsItIsRead) {
  const KittiMounting written = written_kitti_mounting();
  const TempFolder folder;
  const KittiCalibTexts texts = format_kitti_mounting(written);
  folder.write("calib_imu_to_velo.txt", texts.imu_to_velo);
  folder.write("calib_velo_to_cam.txt", texts.velo_to_cam);
  folder.write("calib_cam_to_cam.txt", texts.cam_to_cam);
  for (const KittiMounting& read : {read_kitti_mounting(folder.path()),
                                    parse_tracking_calib(format_tracking_calib(written), "c")}) {
    EXPECT_EQ(read.lidar_from_imu.matrix(), written.lidar_from_imu.matrix());
    EXPECT_EQ(read.view.rectified_from_lidar.matrix(), written.view.rectified_from_lidar.matrix());
    EXPECT_EQ(read.view.pixel_from_rectified, written.view.pixel_from_rectified);
    EXPECT_EQ(read.view.width_px, written.view.width_px);
    EXPECT_EQ(read.view.height_px, written.view.height_px);
  }
}

/// As KITTI's own files are, with two poses.
const std::string kTracklets =
    R"(<?xml version="1.0" encoding="UTF-8" standalone="yes" ?>
<!DOCTYPE boost_serialization>
<boost_serialization signature="serialization::archive" version="9">
<tracklets class_id="0" tracking_level="0" version="0">
	<count>1</count>
	<item_version>1</item_version>
	<item class_id="1" tracking_level="0" version="1">
		<objectType>Person (sitting)</objectType>
		<h>1.5</h>
		<w>1.75</w>
		<l>4</l>
		<first_frame>3</first_frame>
		<poses class_id="2" tracking_level="0" version="0">
			<count>2</count>
			<item_version>2</item_version>
			<item class_id="3" tracking_level="0" version="2">
				<tx>13.5</tx><ty>2.25</ty><tz>-1.5</tz>
				<rx>0</rx><ry>0</ry><rz>-1.25</rz>
				<state>2</state><occlusion>0</occlusion><amt_border_l>1.#QNAN</amt_border_l>
			</item>
			<item><tx>1e1</tx><ty>0</ty><tz>0</tz><rx>0</rx><ry>-0</ry><rz>3</rz></item>
		</poses>
		<finished>1</finished>
	</item>
</tracklets>
</boost_serialization>
)";

std::string tracklet_error(const std::string& from, const std::string& to) {
  std::string text = kTracklets;
  text.replace(text.find(from), from.size(), to);
  return message_of<DataError>([&] { parse_tracklets(text, "x.xml"); });
}

TEST(Tracklets, GiveBoxesByFrame) {
  const auto tracklets = parse_tracklets(kTracklets, "x.xml");
  ASSERT_EQ(tracklets.size(), 1U);
  const Tracklet& person = tracklets.front();
  EXPECT_EQ(person.type, "Person (sitting)");
  EXPECT_EQ(person.height_m, 1.5);
  EXPECT_EQ(person.width_m, 1.75);
  EXPECT_EQ(person.length_m, 4.0);
  EXPECT_EQ(person.first_frame, 3U);
  ASSERT_EQ(person.poses.size(), 2U);
  EXPECT_EQ(person.poses[0].bottom_m, Eigen::Vector3d(13.5, 2.25, -1.5));
  EXPECT_EQ(person.poses[0].yaw_rad, -1.25);
  EXPECT_EQ(person.poses[1].yaw_rad, 3.0);
}

TEST(Tracklets, AreWrittenAsTheyAreRead) {
  auto tracklets = parse_tracklets(kTracklets, "x.xml");
  tracklets[0].type = "a < b & c > d";
  tracklets.push_back({"none", 0, 0, 0.1, 7, {}});
  const std::string text = format_tracklets(tracklets);
  const auto again = parse_tracklets(text, "x.xml");
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again[0].type, tracklets[0].type);
  EXPECT_EQ(again[0].poses[0].bottom_m, tracklets[0].poses[0].bottom_m);
  EXPECT_EQ(again[1].length_m, 0.1);
  EXPECT_EQ(format_tracklets(again), text);
}

TEST(Tracklets, RefuseWhatIsNotWhole) {
  EXPECT_THAT(tracklet_error("</boost", "<boost"), HasSubstr("x.xml:"));
  EXPECT_THAT(tracklet_error("<h>1.5</h>", ""), HasSubstr("a tracklet lacks elements"));
  EXPECT_THAT(tracklet_error("<h>1.5</h>", "<h>1.5</h><h>1</h>"), HasSubstr("twice"));
  EXPECT_THAT(tracklet_error("1.75", "-1.75"), HasSubstr("x.xml:24: a size is below 0"));
  EXPECT_THAT(tracklet_error("1.75", "wide"), HasSubstr("w is \"wide\", expected a number"));
  EXPECT_THAT(tracklet_error("<rx>0", "<rx>0.1"), HasSubstr("turned about x or y"));
  EXPECT_THAT(tracklet_error("<tz>-1.5</tz>", ""), HasSubstr("a pose lacks numbers"));
  EXPECT_THAT(tracklet_error("<count>2", "<count>3"), HasSubstr("number of poses"));
  EXPECT_THAT(tracklet_error("<count>1", "<count>2"), HasSubstr("number of tracklets"));
  EXPECT_THAT(tracklet_error("<first_frame>3", "<first_frame>-3"), HasSubstr("a whole number"));
  EXPECT_THAT(tracklet_error("<first_frame>3", "<first_frame>1000001"), HasSubstr("up to 1000000"));
  EXPECT_THAT(message_of<DataError>([] { parse_tracklets("", "x"); }), HasSubstr("x:1: is no XML"));
  EXPECT_THAT(message_of<DataError>([] { parse_tracklets("<a/>", "x"); }),
              HasSubstr("has no tracklets"));
}

TEST(Tracklets, RefuseXmlThatGrows) {
  EXPECT_THAT(tracklet_error("<!DOCTYPE boost_serialization>",
                             "<!DOCTYPE b [<!ENTITY lol \"lol\"><!ENTITY l2 \"&lol;&lol;\">]>"),
              HasSubstr("declares an entity"));
  EXPECT_THAT(tracklet_error("<!DOCTYPE boost_serialization>",
                             "<!DOCTYPE b [<!ENTITY x SYSTEM \"file:///etc/passwd\">]>"),
              HasSubstr("declares an entity"));
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  EXPECT_THAT(message_of<DataError>([&] { parse_tracklets(deep, "x"); }),
              HasSubstr("elements within elements, expected no more than 16"));
  EXPECT_THAT(tracklet_error("<w>", "<w>" + std::string(1000, '1')), HasSubstr("long text"));
}

TEST(TrackingLabels, GiveBoxesAndRegions) {
  const auto labels = parse_tracking_labels(
      "0 -1 DontCare -1 -1 -10 219.31 188.49 245.5 218.56 -1000 -1000 -1000 -10 -1 -1 -1\n"
      "2 7 Van 0 2 -1.79 296.7 161.75 455.2 292.3 2 1.82 4.43 -4.55 1.85 13.41 -2.11\n",
      "l");
  ASSERT_EQ(labels.size(), 2U);
  EXPECT_FALSE(labels[0].box);
  EXPECT_THAT(labels[0].region_px, ElementsAre(219.31, 188.49, 245.5, 218.56));
  EXPECT_EQ(labels[1].frame, 2U);
  EXPECT_EQ(labels[1].track, 7);
  EXPECT_EQ(labels[1].type, "Van");
  EXPECT_EQ(labels[1].box->height_m, 2.0);
  EXPECT_EQ(labels[1].box->width_m, 1.82);
  EXPECT_EQ(labels[1].box->length_m, 4.43);
  EXPECT_EQ(labels[1].box->bottom_m, Eigen::Vector3d(-4.55, 1.85, 13.41));
  EXPECT_EQ(labels[1].box->rotation_y_rad, -2.11);
  const std::string text = format_tracking_labels(labels);
  EXPECT_EQ(format_tracking_labels(parse_tracking_labels(text, "l")), text);
}

TEST(TrackingLabels, RefuseOtherLines) {
  const std::string good = "2 7 Van 0 2 -1.79 296.7 161.75 455.2 292.3 2 1.82 4.43 -4.5 1.8 13 -2";
  const auto error = [&](const std::string& from, const std::string& to) {
    std::string line = good;
    line.replace(line.find(from), from.size(), to);
    return message_of<DataError>([&] { parse_tracking_labels(line + "\n", "l"); });
  };
  EXPECT_EQ(error("-2", "-2 0.9"), "nothing thrown") << "a score";
  EXPECT_THAT(error(" -2", ""), HasSubstr("l:1: has 16 columns"));
  EXPECT_THAT(error("2 7", "-2 7"), HasSubstr("is no frame"));
  EXPECT_THAT(error("7 Van", "7.5 Van"), HasSubstr("is no track"));
  EXPECT_THAT(error("7 Van", "-1 Van"), HasSubstr("an object has the track \"-1\""));
  EXPECT_THAT(error("1.82", "-1.82"), HasSubstr("a size is below 0"));
  EXPECT_THAT(error("13", "inf"), HasSubstr("is no number"));
  EXPECT_THAT(error("-2", "-2\n" + good), HasSubstr("l:2: track 7 is twice in frame 2"));
}

TEST(TrackingLabels, RefusesMoreRegionsThanAnybodyDraws) {
  const auto regions = [](std::size_t count, std::size_t frames) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      text += fmt::format("{} -1 DontCare -1 -1 -10 0 0 9 9 -1 -1 -1 -1000 -1000 -1000 -10\n",
                          i % frames);
    }
    return text;
  };
  EXPECT_EQ(parse_tracking_labels(regions(2000, 2), "l.txt").size(), 2000U);
  EXPECT_THAT(message_of<DataError>([&] { parse_tracking_labels(regions(2001, 2), "l.txt"); }),
              HasSubstr("l.txt:2001: frame 0 has more regions of DontCare, expected 1000 at most"));
}

TEST(Oxts, KnowsWhatNoPacketCanSay) {
  std::vector<Pose> poses(2, Pose::Identity());
  poses[1].translation() << 1000, 2000, 10;
  EXPECT_TRUE(is_on_map(oxts_of_poses(poses)[1]));
  for (const Eigen::Vector3d& far : {Eigen::Vector3d(0, 4e7, 0), Eigen::Vector3d(1e9, 0, 0)}) {
    poses[1].translation() = far;
    EXPECT_FALSE(is_on_map(oxts_of_poses(poses)[1]));
  }
  OxtsPacket packet;
  packet.yaw_rad = std::nan("");
  EXPECT_FALSE(is_on_map(packet));
}

}  // namespace
}  // namespace mosbench
