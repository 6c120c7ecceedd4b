#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/pose_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

std::string pcd(const std::string& fields, const std::string& viewpoint, const std::string& rows) {
  std::string sizes, types, counts;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(std::ranges::count(fields, ' ')); ++i) {
    sizes += " 4";
    types += " F";
    counts += " 1";
  }
  const std::string points = std::to_string(std::ranges::count(rows, '\n'));
  return "VERSION 0.7\nFIELDS " + fields + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" +
         counts + "\nWIDTH " + points + "\nHEIGHT 1\nVIEWPOINT " + viewpoint + "\nPOINTS " +
         points + "\nDATA ascii\n" + rows;
}

constexpr const char* kOrigin = "0 0 0 1 0 0 0";
constexpr const char* kIdentityRow = "1 0 0 0 0 1 0 0 0 0 1 0\n";

TEST(MoeLabels, TakeTheSecondNumber) {
  EXPECT_THAT(parse_moe_labels("1 1 3\n1 0 -1\n0 0 -1\n", 3, "f"),
              ElementsAre(kMovingLabel, kStaticLabel, kStaticLabel));
  const auto error_of = [](const char* text) {
    return message_of<DataError>([&] { parse_moe_labels(text, 2, "f"); });
  };
  EXPECT_THAT(error_of("1 1 3\n"), HasSubstr("has 1 label, expected one for each of the 2 points"));
  EXPECT_THAT(error_of("1 1 3\n1 2 3\n"), HasSubstr("f:2: \"1 2 3\" is no label of MOE"));
  EXPECT_THAT(error_of("1 1\n1 0\n"), HasSubstr("f:1: "));
}

class PcdReaders : public testing::Test {
 protected:
  TempFolder folder_;
};

TEST_F(PcdReaders, ReadMoe) {
  folder_.write("moe/00/pcd/000000.pcd", pcd("x y z", kOrigin, "1 2 3\n4 5 6\n"));
  folder_.write("moe/00/label/000000.txt", "1 1 3\n0 0 -1\n");
  folder_.write("moe/00/gt_poses.txt", "1 0 0 7 0 1 0 0 0 0 1 0\n");
  const Dataset dataset = open_dataset(folder_ / "moe", {});
  EXPECT_EQ(dataset.kind, DatasetKind::kMoe);
  ASSERT_EQ(dataset.sequences.size(), 1U);
  const Frame frame = dataset.sequences[0]->read(0);
  EXPECT_EQ(frame.points.at(1).y, 5.0F);
  EXPECT_EQ(frame.map_from_sensor.translation().x(), 7.0);
  EXPECT_THAT(*frame.truth, ElementsAre(kMovingLabel, kStaticLabel));
}

TEST_F(PcdReaders, ReadKthInTheSensorsFrameWithoutItsTruthInIntensity) {
  // A quarter turn about z at (10, 0, 0): ahead of the sensor is the map's y.
  const char* viewpoint = "10 0 0 0.70710678118654752 0 0 0.70710678118654752";
  folder_.write("kth/07/pcd/000001.pcd", pcd("x y z intensity", viewpoint, "10 4 1 1\n8 0 0 0\n"));
  folder_.write("kth/07/gt_cloud.pcd", "");
  const Dataset dataset = open_dataset(folder_ / "kth", {});
  EXPECT_EQ(dataset.kind, DatasetKind::kKth);
  const Frame frame = dataset.sequences.at(0)->read(0);
  ASSERT_EQ(frame.points.size(), 2U);
  EXPECT_NEAR(frame.points[0].x, 4.0, 1e-6);
  EXPECT_NEAR(frame.points[0].y, 0.0, 1e-6);
  EXPECT_NEAR(frame.points[1].y, 2.0, 1e-6);
  EXPECT_EQ(frame.points[0].intensity, 0.0F);
  EXPECT_THAT(*frame.truth, ElementsAre(kMovingLabel, kStaticLabel));
  EXPECT_EQ(frame.map_from_sensor.translation().x(), 10.0);
  folder_.write("kth/07/pcd/000002.pcd", pcd("x y z", "0 0 0 2 0 0 0", "1 1 1\n"));
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "kth", {}); }),
              HasSubstr("VIEWPOINT is no pose"));
}

/// Scans of another program hold reflectances there.
TEST_F(PcdReaders, RefuseIntensitiesThatAreNoTruthOfKth) {
  for (const char* intensity : {"0.37", "2", "-1", "nan", "0.999999"}) {
    folder_.write("kth/07/pcd/000001.pcd", pcd("x y z intensity", kOrigin,
                                               "1 2 3 1\n4 5 6 " + std::string(intensity) + "\n"));
    const Dataset dataset = open_dataset(folder_ / "kth", {.kind = DatasetKind::kKth});
    const Sequence& sequence = *dataset.sequences.at(0);
    const auto wanted = HasSubstr("000001.pcd: point 1 has intensity " + std::string(intensity) +
                                  ", expected 0 (static) or 1 (dynamic)");
    EXPECT_THAT(message_of<DataError>([&] { sequence.read(0); }), wanted);
    EXPECT_THAT(message_of<DataError>([&] { sequence.read_truth(0); }), wanted);
  }
}

TEST_F(PcdReaders, TakeLabelsFromAFieldOfThatName) {
  folder_.write("s/velodyne/000000.pcd", pcd("x y z label", kOrigin, "1 2 3 251\n4 5 6 9\n"));
  folder_.write("s/poses.txt", kIdentityRow);
  const Dataset dataset = open_dataset(folder_ / "s", {});
  EXPECT_THAT(*dataset.sequences[0]->read(0).truth, ElementsAre(251U, 9U));
  folder_.write("s/velodyne/000000.pcd", pcd("x y z label", kOrigin, "1 2 3 0.5\n"));
  const Dataset spoiled = open_dataset(folder_ / "s", {});
  EXPECT_THAT(message_of<DataError>([&] { spoiled.sequences[0]->read(0); }),
              HasSubstr("point 0 has the label 0.5"));
}

class KittiReaders : public testing::Test {
 protected:
  void write(const std::string& sequence) const {
    write_bin(folder_ / (sequence + "/velodyne/000000.bin"),
              std::vector<Point>(3, Point{1, 2, 3, 4}));
    write_labels(folder_ / (sequence + "/labels/000000.label"),
                 std::vector<std::uint32_t>{251, 65535, 0});
    folder_.write(sequence + "/calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 0\n");
    folder_.write(sequence + "/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 5\n");
  }
  TempFolder folder_;
};

TEST_F(KittiReaders, ReadApolloWithItsLidarPosesWhereTheyAre) {
  write("LiDAR-MOS/sequences/00");
  const OpenOptions apollo = {.kind = DatasetKind::kApollo};
  const auto x_of = [&](const Dataset& dataset) {
    return dataset.sequences.at(0)->read(0).map_from_sensor.translation().x();
  };
  EXPECT_EQ(x_of(open_dataset(folder_ / "LiDAR-MOS", apollo)), 5.0);  // camera, by Tr
  folder_.write("LiDAR-MOS/sequences/00/velodyne_poses_kitti.txt", "1 0 0 6 0 1 0 0 0 0 1 0\n");
  const Dataset recognised = open_dataset(folder_ / "LiDAR-MOS", {});
  EXPECT_EQ(recognised.kind, DatasetKind::kApollo);
  EXPECT_EQ(x_of(recognised), 6.0);
  EXPECT_THAT(members_of(recognised.sequences[0]->reading()),
              Contains(Pair("pose_frame", "lidar")));
}

TEST_F(KittiReaders, ReadMdetectorsLabelsAsTheyAre) {
  write("M-detector/sequences/0000");
  const Dataset dataset = open_dataset(folder_ / "M-detector", {});
  EXPECT_EQ(dataset.kind, DatasetKind::kMdetector);
  EXPECT_THAT(*dataset.sequences.at(0)->read(0).truth, ElementsAre(251U, 65535U, 0U));
}

TEST_F(KittiReaders, ReadFiveColumnsWhenToldOrByTheNuscenesName) {
  ByteSink sink;
  for (const float value : {1.0F, 2.0F, 3.0F, 4.0F, 31.0F, 5.0F, 6.0F, 7.0F, 8.0F, 30.0F}) {
    sink.put(value);
  }
  const std::string bytes = std::move(sink).bytes();
  folder_.write("told/velodyne/000000.bin", bytes);
  folder_.write("told/poses.txt", kIdentityRow);
  folder_.write("named/LIDAR_TOP/1533151603547590.pcd.bin", bytes);
  folder_.write("named/poses.txt", kIdentityRow);
  const Dataset told = open_dataset(folder_ / "told", {.reading = {.bin_columns = 5}});
  const Dataset named = open_dataset(folder_ / "named", {});
  for (const Dataset* dataset : {&told, &named}) {
    const Frame frame = dataset->sequences.at(0)->read(0);
    ASSERT_EQ(frame.points.size(), 2U);
    EXPECT_EQ(frame.points[1].x, 5.0F);
    EXPECT_EQ(frame.points[1].intensity, 8.0F);
  }
  EXPECT_EQ(named.sequences[0]->stem(0), "1533151603547590");
  // Runs that read other columns of the same files are other runs.
  EXPECT_THAT(members_of(told.sequences[0]->reading()),
              testing::Contains(testing::Pair("bin_columns", "5")));
  EXPECT_THAT(members_of(named.sequences[0]->reading()),
              testing::Not(testing::Contains(testing::Key("bin_columns"))));
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder_ / "told", {}); }),
              HasSubstr("40 bytes are no multiple of 16"));
}

}  // namespace
}  // namespace mosbench
