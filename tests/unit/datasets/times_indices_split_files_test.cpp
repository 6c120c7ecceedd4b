#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "datasets/disk/files.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/text/errors.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(TimesFile, ReadsNineteenDigitsExactly) {
  // As double these would be 238 ns apart at best.
  EXPECT_EQ(parse_seconds_as_ns("1582193985.123456789"), 1582193985123456789);
  EXPECT_EQ(parse_seconds_as_ns("1582193985.123456788"), 1582193985123456788);
}

TEST(TimesFile, ReadsKittiExponents) {
  EXPECT_EQ(parse_seconds_as_ns("0.000000e+00"), 0);
  EXPECT_EQ(parse_seconds_as_ns("1.036224e-01"), 103622400);
  EXPECT_EQ(parse_seconds_as_ns("4.706463E+02"), 470646300000);
  EXPECT_EQ(parse_seconds_as_ns("12e3"), 12000000000000);
}

TEST(TimesFile, RoundsBehindTheNinthDecimal) {
  EXPECT_EQ(parse_seconds_as_ns("0.0000000014"), 1);
  EXPECT_EQ(parse_seconds_as_ns("0.0000000015"), 2);
  EXPECT_EQ(parse_seconds_as_ns("-0.0000000015"), -2);
  EXPECT_EQ(parse_seconds_as_ns("9e-10"), 1);
  EXPECT_EQ(parse_seconds_as_ns("9e-11"), 0);
  EXPECT_EQ(parse_seconds_as_ns("1.9999999996"), 2000000000);
}

TEST(TimesFile, KnowsTheLimitsOf64Bits) {
  EXPECT_EQ(parse_seconds_as_ns("9223372036.854775807"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(parse_seconds_as_ns("9223372036.854775808"), std::nullopt);
  EXPECT_EQ(parse_seconds_as_ns("9223372036.8547758075"), std::nullopt);
  EXPECT_EQ(parse_seconds_as_ns("1582193985123456789"), std::nullopt);
  EXPECT_EQ(parse_seconds_as_ns("1e2147483647"), std::nullopt);
  EXPECT_EQ(parse_seconds_as_ns("0e2147483647"), 0);
  EXPECT_EQ(parse_seconds_as_ns("1e-2147483647"), 0);
}

TEST(TimesFile, RefusesText) {
  for (const char* text :
       {"", ".", "-", "1.2.3", "1e", "1e+", "1e+-2", "nan", "12s", "1 2", "--1"}) {
    EXPECT_EQ(parse_seconds_as_ns(text), std::nullopt) << text;
  }
  EXPECT_THAT(message_of<DataError>([] { parse_times("0.0\nnoon\n", "times.txt"); }),
              AllOf(HasSubstr("times.txt:2: \"noon\""), HasSubstr("seconds")));
}

TEST(TimesFile, WritesWhatItReads) {
  const TempFolder folder;
  const std::vector<std::int64_t> stamps_ns = {
      0, 1, -1, 999999999, 1582193985123456789, std::numeric_limits<std::int64_t>::max()};
  write_times(folder / "times.txt", stamps_ns);
  EXPECT_EQ(read_times(folder / "times.txt"), stamps_ns);
}

TEST(IndicesFile, SortsIndicesAndCollapsesRepeatedOnes) {
  const auto rows = parse_indices("1582193985123456789,64,3,64,0\n1582193985223456789\n", "i.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].stamp_ns, 1582193985123456789);
  EXPECT_THAT(rows[0].moving, ElementsAre(0U, 3U, 64U));
  EXPECT_THAT(rows[1].moving, IsEmpty());
  EXPECT_EQ(rows[1].line, 2U);
}

TEST(IndicesFile, ToleratesBlanksACommaAtTheEndAndDosLines) {
  const auto rows = parse_indices("10, 1,2,\r\n20,\r\n\r\n", "i.csv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_THAT(rows[0].moving, ElementsAre(1U, 2U));
  EXPECT_THAT(rows[1].moving, IsEmpty());
}

TEST(IndicesFile, NamesTheLineOfEveryFault) {
  const auto error_of = [](const std::string& text) {
    return message_of<DataError>([&] { parse_indices(text, "indices.csv"); });
  };
  EXPECT_THAT(error_of("10,1\n20,-3\n"), HasSubstr("indices.csv:2: \"-3\" is no point index"));
  EXPECT_THAT(error_of("10,one\n"), HasSubstr("indices.csv:1: \"one\""));
  EXPECT_THAT(error_of("10,1,,2\n"), HasSubstr("indices.csv:1: \"\" is no point index"));
  EXPECT_THAT(error_of("10,4294967296\n"), HasSubstr("is no point index"));
  EXPECT_THAT(error_of("-10,1\n"), HasSubstr("\"-10\" is no time stamp"));
  EXPECT_THAT(error_of("9223372036854775808,1\n"), HasSubstr("is no time stamp"));
  EXPECT_THAT(error_of("1.5e9,1\n"), HasSubstr("is no time stamp"));
  EXPECT_THAT(error_of("10,1\n20,1\n10,2\n"),
              HasSubstr("indices.csv:3: stamp 10 for the second time"));
}

TEST(IndicesFile, ChecksIndicesAgainstTheScan) {
  const auto rows = parse_indices("10,1\n20,0,5\n", "indices.csv");
  EXPECT_NO_THROW(check_indices(rows[1], 6, "indices.csv"));
  EXPECT_THAT(message_of<DataError>([&] { check_indices(rows[1], 5, "indices.csv"); }),
              AllOf(HasSubstr("indices.csv:2: index 5 is beyond"), HasSubstr("5 points")));
  EXPECT_NO_THROW(check_indices(parse_indices("10\n", "i.csv")[0], 0, "i.csv"));
}

TEST(IndicesFile, WritesWhatItReads) {
  const TempFolder folder;
  const std::vector<IndicesRow> rows = {{.stamp_ns = 7, .moving = {1, 2, 131071}, .line = 1},
                                        {.stamp_ns = 8, .moving = {}, .line = 2}};
  write_file_atomic(folder / "indices.csv", format_indices(rows));
  const auto again = read_indices(folder / "indices.csv");
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again[0].moving, rows[0].moving);
  EXPECT_EQ(again[1].stamp_ns, 8);
}

TEST(SplitFile, TakesOneNumberPerLine) {
  EXPECT_THAT(parse_split("001015\n7\r\n7\n\n", "test.txt"), ElementsAre(7U, 1015U));
}

TEST(SplitFile, RefusesTextAndAnEmptyFile) {
  const auto error_of = [](const std::string& text) {
    return message_of<DataError>([&] { parse_split(text, "test.txt"); });
  };
  EXPECT_THAT(error_of("1\nAeva/2\n"), HasSubstr("test.txt:2: \"Aeva/2\""));
  EXPECT_THAT(error_of("1 2\n"), HasSubstr("test.txt:1"));
  EXPECT_THAT(error_of("-1\n"), HasSubstr("test.txt:1"));
  EXPECT_THAT(error_of(" \n"), HasSubstr("holds no frame number"));
}

TEST(SplitFile, WritesWhatItReads) {
  const TempFolder folder;
  write_file_atomic(folder / "val.txt", format_split({3, 1, 12476}));
  EXPECT_THAT(parse_split(read_file(folder / "val.txt"), "val.txt"), ElementsAre(1U, 3U, 12476U));
}

}  // namespace
}  // namespace mosbench
