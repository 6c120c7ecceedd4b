#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(BinFile, IsLittleEndianFloat32InTheOrderXyzIntensity) {
  const std::string bytes("\0\0\x80\x3f\0\0\0\x40\0\0\x40\xc0\0\0\0\x3f", 16);
  const auto points = parse_bin(bytes, 4, "scan.bin");
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].x, 1.0F);
  EXPECT_EQ(points[0].y, 2.0F);
  EXPECT_EQ(points[0].z, -3.0F);
  EXPECT_EQ(points[0].intensity, 0.5F);
  EXPECT_EQ(format_bin(points), bytes);
}

TEST(BinFile, WithoutBytesIsAnEmptyScan) {
  EXPECT_THAT(parse_bin("", 4, "scan.bin"), IsEmpty());
  EXPECT_EQ(format_bin({}), "");
}

TEST(BinFile, KeepsNanAndInfinityAsTheyAre) {
  const float payload_nan = std::bit_cast<float>(0x7fc01234U);
  const std::vector<Point> points = {
      {payload_nan, std::numeric_limits<float>::infinity(), -0.0F, 1}};
  const auto bytes = format_bin(points);
  EXPECT_EQ(format_bin(parse_bin(bytes, 4, "scan.bin")), bytes);
}

TEST(BinFile, RefusesASizeThatIsNoMultipleOf16) {
  const auto message = message_of<DataError>([] { parse_bin(std::string(30, 'x'), 4, "a/7.bin"); });
  EXPECT_THAT(message, AllOf(HasSubstr("a/7.bin: 30 bytes"), HasSubstr("another layout"),
                             HasSubstr("expected 4 float32")));
}

TEST(BinFile, ReadsBackFromDisk) {
  const TempFolder folder;
  const std::vector<Point> points = {{1, 2, 3, 4}, {5, 6, 7, 8}};
  write_bin(folder / "velodyne/000000.bin", points);
  EXPECT_EQ(format_bin(read_bin(folder / "velodyne/000000.bin")), format_bin(points));
}

TEST(BinFile, HoldsNoPointOfTheScanWhoseMemoryItTakes) {
  const TempFolder folder;
  const std::vector<Point> points = {{1, 2, 3, 4}, {5, 6, 7, 8}};
  write_bin(folder / "0.bin", points);
  for (const std::size_t reused : {0U, 1U, 2U, 9U}) {
    const auto read = read_bin(folder / "0.bin", 4, std::vector<Point>(reused, Point{9, 9, 9, 9}));
    EXPECT_EQ(format_bin(read), format_bin(points)) << reused;
  }
  write_bin(folder / "empty.bin", {});
  EXPECT_TRUE(read_bin(folder / "empty.bin", 4, points).empty());
}

TEST(LabelFile, KeepsAll32Bits) {
  const std::string bytes("\xfb\0\x05\0\x09\0\0\0", 8);
  const auto labels = parse_labels(bytes, 2, "a.label");
  EXPECT_THAT(labels, ElementsAre(0x000500fbU, 9U));
  EXPECT_EQ(format_labels(labels), bytes);
}

TEST(LabelFile, RefusesFewerAndMoreLabelsThanPoints) {
  for (const std::size_t bytes : {7U, 4U, 12U, 0U}) {
    const auto message =
        message_of<DataError>([&] { parse_labels(std::string(bytes, '\0'), 2, "a.label"); });
    EXPECT_THAT(message, AllOf(HasSubstr("a.label: has " + std::to_string(bytes) + " bytes"),
                               HasSubstr("2 points"), HasSubstr("8 bytes")));
  }
}

TEST(LabelFile, ReadsBackFromDisk) {
  const TempFolder folder;
  const std::vector<std::uint32_t> labels = {0, 9, 251};
  write_labels(folder / "labels/000000.label", labels);
  EXPECT_EQ(read_labels(folder / "labels/000000.label", 3), labels);
  EXPECT_THROW(read_labels(folder / "labels/000000.label", 4), DataError);
}

}  // namespace
}  // namespace mosbench
