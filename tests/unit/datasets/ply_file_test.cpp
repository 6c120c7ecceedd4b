#include "datasets/formats/ply_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/byte_cursor.hpp"
#include "datasets/text/errors.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::HasSubstr;

std::string header(const std::string& format, const std::string& properties) {
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex 2\n" + properties +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

constexpr const char* kXyz =
    "property double z\nproperty float x\nproperty short y\nproperty uchar intensity\n";

TEST(PlyFile, FindsPropertiesByNameInEveryFormat) {
  const std::string ascii = header("ascii", kXyz) + "1.5 2 -3 4\n5 6 7 8\n3 0 1 0\n";
  ByteSink body;
  for (const auto& [z, x, y, intensity] : {std::tuple{1.5, 2.0F, std::int16_t{-3}, std::uint8_t{4}},
                                           {5.0, 6.0F, std::int16_t{7}, std::uint8_t{8}}}) {
    body.put(z);
    body.put(x);
    body.put(y);
    body.put(intensity);
  }
  const std::string little = header("binary_little_endian", kXyz) + std::move(body).bytes();
  for (const std::string& bytes : {ascii, little}) {
    const auto points = parse_ply(bytes, "f");
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(parse_ply_summary(bytes, bytes.size(), "f").points, 2U);
    EXPECT_EQ(points[0].x, 2.0F);
    EXPECT_EQ(points[0].y, -3.0F);
    EXPECT_EQ(points[0].z, 1.5F);
    EXPECT_EQ(points[1].intensity, 8.0F);
  }
  const std::string big = header("binary_big_endian",
                                 "property float x\nproperty float y\n"
                                 "property float z\n") +
                          std::string("\x3f\x80\0\0\0\0\0\0\0\0\0\0", 12) + std::string(12, '\0');
  EXPECT_EQ(parse_ply(big, "f")[0].x, 1.0F);
}

TEST(PlyFile, KnowsTheWidthOfEveryTypeByBothItsNames) {
  const std::vector<std::pair<std::string, std::size_t>> widths_bytes = {
      {"char", 1},  {"uchar", 1},  {"short", 2},   {"ushort", 2}, {"int", 4},   {"uint", 4},
      {"int8", 1},  {"uint8", 1},  {"int16", 2},   {"uint16", 2}, {"float", 4}, {"double", 8},
      {"int32", 4}, {"uint32", 4}, {"float32", 4}, {"float64", 8}};
  for (const auto& [type, width_bytes] : widths_bytes) {
    const std::string point =
        std::string(width_bytes, '\0') + std::string("\0\0\x80\x3f\0\0\0\0\0\0\0\0", 12);
    const auto points =
        parse_ply(header("binary_little_endian", "property " + type +
                                                     " ring\nproperty float x\n"
                                                     "property float y\nproperty float z\n") +
                      point + point,
                  "f");
    ASSERT_EQ(points.size(), 2U) << type;
    EXPECT_EQ(points[1].x, 1.0F) << type;
  }
}

TEST(PlyFile, RefusesWhatIsNoneOrCutOff) {
  const auto error_of = [](const std::string& bytes) {
    return message_of<DataError>([&] { parse_ply(bytes, "f"); });
  };
  EXPECT_THAT(error_of("plyx\n"), HasSubstr("does not start with \"ply\""));
  EXPECT_THAT(error_of("ply\nformat ascii 1.0\n"), HasSubstr("no line \"end_header\""));
  EXPECT_THAT(error_of("ply\nend_header\n"), HasSubstr("lacks a format"));
  EXPECT_THAT(error_of(header("binary", kXyz)), HasSubstr("format \"binary\""));
  EXPECT_THAT(error_of(header("ascii", "property list uchar float x\n")),
              HasSubstr("no single number"));
  EXPECT_THAT(error_of(header("binary_little_endian", kXyz)), HasSubstr("ends within its points"));
  EXPECT_THAT(error_of(header("ascii", kXyz) + "1 2 3 4\n"), HasSubstr("1 rows of points"));
  EXPECT_THAT(error_of(header("ascii", kXyz) + "1 2 3\n1 2 3\n"), HasSubstr("no row of numbers"));
  EXPECT_THAT(error_of(header("ascii", "property float x\nproperty float y\n") + "1 2\n3 4\n"),
              HasSubstr("no field z"));
}

TEST(PlyFile, HoldsTheFieldsOfTheOusterDriverAndThePointsOfItsBinFile) {
  const auto folder = shared_folder() / "real/os1";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const auto ply = parse_ply(read_file(folder / "000104.ply"), "000104.ply");
  const auto bin = read_bin(folder / "000104.bin");
  ASSERT_EQ(ply.size(), 131072U);
  ASSERT_EQ(ply.size(), bin.size());
}

}  // namespace
}  // namespace mosbench
