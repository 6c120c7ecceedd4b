#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/text/errors.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kTwoPoints =
    "VERSION 0.7\nFIELDS z y x\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    "POINTS 2\nDATA ascii\n3 2 1\n6 5 4\n";

class PcdFile : public testing::Test {
 protected:
  void SetUp() override {
    if (!reads_pcd()) GTEST_SKIP() << "this build is without PCL";
  }
};

TEST_F(PcdFile, EqualsTheBinFilesOfTheSameRealScansBitForBit) {
  const auto folder = shared_folder() / "real/pcd";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  for (const char* stem : {"0000000000", "0000000001", "0000000002", "0000000003", "0000000004"}) {
    const auto bin = read_bin(folder / (std::string(stem) + ".bin"));
    const auto pcd_path = folder / (std::string(stem) + ".pcd");
    const auto pcd = read_pcd(pcd_path);
    ASSERT_GT(bin.size(), 100000U);
    ASSERT_EQ(pcd.size(), bin.size() + 1);
    EXPECT_EQ(read_pcd_header(pcd_path).points, pcd.size());
    EXPECT_EQ(std::memcmp(pcd.data(), bin.data(), bin.size() * sizeof(Point)), 0) << stem;
    const Point extra = {0, 0, 0, 0};
    EXPECT_EQ(std::memcmp(&pcd.back(), &extra, sizeof(Point)), 0) << stem;
  }
}

TEST_F(PcdFile, TakesFourOfEightFields) {
  const auto file = shared_folder() / "real/pcd/eight_fields.pcd";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const auto points = read_pcd(file);
  ASSERT_GT(points.size(), 100000U);
  EXPECT_EQ(read_pcd_header(file).points, points.size());
  for (const Point& point : points) {
    const float range_m = std::hypot(point.x, point.y, point.z);
    ASSERT_TRUE(range_m > 1.0F && range_m < 80.0F);
    ASSERT_TRUE(point.intensity >= 0.0F && point.intensity <= 255.0F);
  }
}

TEST_F(PcdFile, FindsFieldsByNameAndTakesAMissingIntensityAsZero) {
  const TempFolder folder;
  const auto points = read_pcd(folder.write("scan.pcd", kTwoPoints));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].x, 4.0F);
  EXPECT_EQ(points[1].y, 5.0F);
  EXPECT_EQ(points[1].z, 6.0F);
  EXPECT_EQ(points[1].intensity, 0.0F);
}

TEST_F(PcdFile, RefusesWhatIsNoPointCloudWithXyz) {
  const TempFolder folder;
  const auto error_of = [&](const std::string& text) {
    const auto file = folder.write("scan.pcd", text);
    return message_of<DataError>([&] { read_pcd(file); });
  };
  EXPECT_THAT(error_of(""), AllOf(HasSubstr("scan.pcd"), HasSubstr("no header")));
  EXPECT_THAT(error_of("# no header at all\n"), HasSubstr("no header"));
  const auto error_of_changed = [&](const std::string& from, const std::string& to) {
    std::string text = kTwoPoints;
    return error_of(text.replace(text.find(from), from.size(), to));
  };
  EXPECT_THAT(error_of_changed("FIELDS z", "FIELDS h"), HasSubstr("field z"));
  EXPECT_THAT(error_of_changed("SIZE 4 4 4", "SIZE 4 4"), HasSubstr("line SIZE"));
  EXPECT_THAT(error_of_changed("TYPE F", "TYPE X"), HasSubstr("no type of PCD"));
  EXPECT_THAT(error_of_changed("HEIGHT 1", "HEIGHT 2"), HasSubstr("WIDTH * HEIGHT"));
  EXPECT_THAT(error_of_changed("ascii", "binary"), HasSubstr("12 bytes behind the header"));
  EXPECT_THAT(error_of_changed("ascii", "binary_compressed"), HasSubstr("behind the header"));
  EXPECT_THAT(error_of_changed("6 5 4\n", ""), HasSubstr("1 rows of points"));
  EXPECT_THAT(error_of_changed("6 5 4", "6 5"), HasSubstr("point 1 has 2 values"));
  EXPECT_THAT(error_of_changed("6 5 4", "6 five 4"), HasSubstr("\"five\" is no number"));
  // PCL's reader crashes on the points behind such lines.
  EXPECT_THAT(error_of("\xef\xbb\xbf" + std::string(kTwoPoints)), HasSubstr("scan.pcd:1: "));
  EXPECT_THAT(error_of_changed("VERSION 0.7", "PCD v0.7"),
              HasSubstr("scan.pcd:1: \"PCD v0.7\" is no line of a PCD header"));
  EXPECT_THAT(error_of_changed("SIZE", "COLOUR red\nSIZE"), HasSubstr("scan.pcd:3: "));
  EXPECT_THAT(error_of_changed("SIZE", "\r\nSIZE"), HasSubstr("scan.pcd:3: "));
  EXPECT_THAT(error_of_changed("SIZE", "FIELDS x y z\nSIZE"),
              HasSubstr("scan.pcd:3: FIELDS is there twice"));
  EXPECT_THAT(message_of<DataError>([&] { read_pcd(folder / "absent.pcd"); }),
              HasSubstr("absent.pcd"));
}

TEST_F(PcdFile, IsOpenedByItsHeaderAndCheckedAsAWholeWhenRead) {
  const TempFolder folder;
  std::string text = kTwoPoints;
  folder.write("velodyne/000000.pcd", text.replace(text.find("6 5 4"), 5, "6 x 4"));
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const KittiSequence sequence("s", folder.path());
  EXPECT_EQ(sequence.point_count(0), 2U);
  EXPECT_THAT(message_of<DataError>([&] { sequence.read(0); }), HasSubstr("\"x\" is no number"));
}

TEST_F(PcdFile, IsRefusedByItsSizeWhenABinaryBodyIsCutOff) {
  const TempFolder folder;
  std::string text = kTwoPoints;
  const auto file = folder.write("0.pcd", text.replace(text.find("ascii"), 5, "binary"));
  EXPECT_THAT(message_of<DataError>([&] { read_pcd_header(file); }),
              HasSubstr("12 bytes behind the header"));
}

TEST_F(PcdFile, IsAScanOfASequenceLikeAnyOther) {
  const TempFolder folder;
  folder.write("velodyne/000000.pcd", kTwoPoints);
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const KittiSequence sequence("s", folder.path());
  EXPECT_EQ(sequence.point_count(0), 2U);
  EXPECT_EQ(sequence.read(0).points.at(0).x, 1.0F);
}

TEST(PcdFileWithoutPcl, SaysHowToBuildWithIt) {
  if (reads_pcd()) GTEST_SKIP() << "this build has PCL";
  const TempFolder folder;
  folder.write("velodyne/000000.pcd", kTwoPoints);
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(message_of<DataError>([&] { KittiSequence("s", folder.path()); }),
              AllOf(HasSubstr("000000.pcd"), HasSubstr("-DMOSBENCH_WITH_PCL=ON")));
  EXPECT_THROW(read_pcd(folder / "velodyne/000000.pcd"), DataError);
}

}  // namespace
}  // namespace mosbench
