#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

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

/// 23 bytes packed by hand: four as they are, nine from four back, three from one back, seven.
constexpr std::string_view kPacked(
    "\x03"
    "abcd"
    "\xe0\x00\x03"
    "\x20\x00"
    "\x06"
    "1234567",
    18);

TEST(PcdFile, EqualsTheBinFilesOfTheSameRealScansBitForBit) {
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

TEST(PcdFile, TakesFourOfEightFields) {
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

TEST(PcdFile, FindsFieldsByNameAndTakesAMissingIntensityAsZero) {
  const TempFolder folder;
  const auto points = read_pcd(folder.write("scan.pcd", kTwoPoints));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].x, 4.0F);
  EXPECT_EQ(points[1].y, 5.0F);
  EXPECT_EQ(points[1].z, 6.0F);
  EXPECT_EQ(points[1].intensity, 0.0F);
}

TEST(PcdFile, RefusesWhatIsNoPointCloudWithXyz) {
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

TEST(PcdFile, IsOpenedByItsHeaderAndCheckedAsAWholeWhenRead) {
  const TempFolder folder;
  std::string text = kTwoPoints;
  folder.write("velodyne/000000.pcd", text.replace(text.find("6 5 4"), 5, "6 x 4"));
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const KittiSequence sequence("s", folder.path());
  EXPECT_EQ(sequence.point_count(0), 2U);
  EXPECT_THAT(message_of<DataError>([&] { sequence.read(0); }), HasSubstr("\"x\" is no number"));
}

TEST(PcdFile, IsRefusedByItsSizeWhenABinaryBodyIsCutOff) {
  const TempFolder folder;
  std::string text = kTwoPoints;
  const auto file = folder.write("0.pcd", text.replace(text.find("ascii"), 5, "binary"));
  EXPECT_THAT(message_of<DataError>([&] { read_pcd_header(file); }),
              HasSubstr("12 bytes behind the header"));
}

TEST(PcdFile, IsAScanOfASequenceLikeAnyOther) {
  const TempFolder folder;
  folder.write("velodyne/000000.pcd", kTwoPoints);
  folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const KittiSequence sequence("s", folder.path());
  EXPECT_EQ(sequence.point_count(0), 2U);
  EXPECT_EQ(sequence.read(0).points.at(0).x, 1.0F);
}

TEST(Lzf, UnpacksLiteralsAndRunsThatReachIntoThemselves) {
  EXPECT_EQ(unpack_lzf(kPacked, 23), "abcdabcdabcdaaaa1234567");
  EXPECT_EQ(unpack_lzf("", 0), "");
}

TEST(Lzf, RefusesWhatIsCutOffOrReachesBeyondItsEnds) {
  for (std::size_t size = 0; size < kPacked.size(); ++size) {
    EXPECT_EQ(unpack_lzf(kPacked.substr(0, size), 23), std::nullopt) << size;
  }
  EXPECT_EQ(unpack_lzf(kPacked, 22), std::nullopt);
  EXPECT_EQ(unpack_lzf(kPacked, 24), std::nullopt);
  EXPECT_EQ(unpack_lzf(std::string_view("\x00"
                                        "a"
                                        "\x20\x01",
                                        4),
                       4),
            std::nullopt)
      << "before the start";
  EXPECT_EQ(unpack_lzf("a", std::size_t{1} << 40U), std::nullopt) << "more than it can hold";
}

std::string compressed_cloud(std::string_view packed, std::uint32_t unpacked_bytes) {
  std::string text = kTwoPoints;
  text.replace(text.find("ascii"), std::string::npos, "binary_compressed\n");
  const std::array<std::uint32_t, 2> sizes_bytes = {static_cast<std::uint32_t>(packed.size()),
                                                    unpacked_bytes};
  text.append(reinterpret_cast<const char*>(sizes_bytes.data()), sizeof(sizes_bytes));
  return text.append(packed);
}

TEST(PcdFile, UnpacksFieldsThatLieOneAfterAnother) {
  const std::array<float, 6> z_y_x = {3, 6, 2, 5, 1, 4};
  std::string packed(1, static_cast<char>(sizeof(z_y_x) - 1));
  packed.append(reinterpret_cast<const char*>(z_y_x.data()), sizeof(z_y_x));
  const auto points = parse_pcd(compressed_cloud(packed, sizeof(z_y_x)), "f").points;
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].x, 1.0F);
  EXPECT_EQ(points[0].z, 3.0F);
  EXPECT_EQ(points[1].x, 4.0F);
  EXPECT_EQ(points[1].y, 5.0F);
  const auto error_of = [](const std::string& bytes) {
    return message_of<DataError>([&] { parse_pcd(bytes, "f"); });
  };
  EXPECT_THAT(error_of(compressed_cloud(packed, 20)), HasSubstr("20 bytes of compressed points"));
  EXPECT_THAT(error_of(compressed_cloud(packed.substr(0, 9), sizeof(z_y_x))),
              HasSubstr("compressed points are damaged, expected 24 bytes packed by LZF"));
}

TEST(PcdFile, RoundsTextToTheTypeOfItsField) {
  const auto value_of = [](std::string number, const std::string& type, const std::string& size) {
    return parse_pcd("FIELDS x y z\nSIZE 4 4 " + size + "\nTYPE F F " + type +
                         "\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n0 nan " + number + "\n",
                     "f")
        .points.at(0)
        .z;
  };
  EXPECT_EQ(value_of("0.1", "F", "4"), 0.1F);
  EXPECT_EQ(value_of("0.1", "F", "8"), 0.1F);
  EXPECT_EQ(value_of("300", "U", "1"), 255.0F);
  EXPECT_EQ(value_of("-7", "I", "2"), -7.0F);
  EXPECT_EQ(value_of("4294967295", "U", "4"), 4294967296.0F);
}

}  // namespace
}  // namespace mosbench
