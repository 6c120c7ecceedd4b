#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "datasets/text/errors.hpp"
#include "eval/report/point_planes.hpp"
#include "eval/report/report.hpp"
#include "eval/report/scan_choice.hpp"
#include "eval/result/result_scans.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using Scans = std::vector<std::size_t>;

/// Scans whose false points are the given numbers.
std::vector<ScanRow> rows_with(const std::vector<std::uint64_t>& false_points) {
  std::vector<ScanRow> rows;
  for (const std::uint64_t fp : false_points) {
    rows.emplace_back();
    rows.back().counts = Confusion{.fp = fp};
  }
  return rows;
}

TEST(WorstFirst, HasScansInWhichNothingWasLookedForBehindAllOthers) {
  std::vector<ScanRow> rows = rows_with({5, 90, 7});
  rows[1].judged = false;
  EXPECT_EQ(worst_first(rows), (Scans{2, 0, 1}));
}

TEST(ScanChoice, ReadsListsInTheOrderOfTheirWords) {
  const auto rows = rows_with({0, 5, 0, 9, 0, 0, 7, 0});
  EXPECT_EQ(ScanChoice("6,1-2,99").wanted(rows), (Scans{6, 1, 2}));
  EXPECT_EQ(ScanChoice("every:3").wanted(rows), (Scans{0, 3, 6}));
  EXPECT_EQ(ScanChoice("worst:2,0-1").wanted(rows), (Scans{3, 6, 0, 1}));
  EXPECT_EQ(ScanChoice("worst:99").wanted(rows).size(), 8U);
  EXPECT_TRUE(ScanChoice("none").none());
  EXPECT_EQ(ScanChoice("every:18446744073709551615").wanted(rows), (Scans{0}));
}

TEST(ScanChoice, KnowsNoWorstScansWithoutTruth) {
  auto rows = rows_with({4, 5, 6});
  rows[2].counts.reset();
  EXPECT_EQ(ScanChoice("worst:9").wanted(rows), (Scans{1, 0}));
  EXPECT_EQ(ScanChoice("auto").wanted(rows), (Scans{1, 0, 2}));
  for (ScanRow& row : rows) row.counts.reset();
  EXPECT_TRUE(ScanChoice("worst:1").wanted(rows).empty());
}

TEST(ScanChoice, AutoWantsTheWorstTenthAndThenEveryScanOnce) {
  for (const std::size_t n : {1U, 2U, 3U, 10U, 33U, 64U, 100U}) {
    std::vector<std::uint64_t> false_points(n, 0);
    false_points[n / 2] = 3;
    const Scans wanted = ScanChoice("auto").wanted(rows_with(false_points));
    EXPECT_EQ(wanted.front(), n / 2);
    EXPECT_EQ(wanted.size(), n);
    EXPECT_EQ(std::set<std::size_t>(wanted.begin(), wanted.end()).size(), n);
  }
}

TEST(ScanChoice, RefusesWhatItDoesNotKnow) {
  for (const char* text :
       {"", "best", "3-1", "-2", "1,,2", "every:0", "worst:", "1-", "1.5", "worst:-1"}) {
    EXPECT_THROW(ScanChoice{text}, UsageError) << text;
  }
}

TEST(PointPlanes, HoldDifferencesOfCentimetresInZigzag) {
  const std::vector<Point> points = {{0.01F, -0.01F, 3.0F, 0}, {0.02F, -0.03F, 0.0F, 0}};
  const std::string planes = position_planes(points);
  // x: +1 +1; y: -1 -2; z: +300 -300; low bytes then high ones.
  const std::vector<unsigned> expected = {2, 2, 1, 3, 600 & 255, 599 & 255, 0, 0, 0, 0, 2, 2};
  ASSERT_EQ(planes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(static_cast<unsigned char>(planes[i]), expected[i]) << i;
  }
}

TEST(PointPlanes, MarkPointsThatHaveNoPlace) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Point> points = {{1, 1, 1, 0},    {kNan, 1, 1, 0},     {1, 328, 1, 0},
                                     {0, 0, 0, 0.5F}, {1, 1, -327.67F, 0}, {1, INFINITY, 1, 0}};
  const std::vector<PointOutcome> outcomes(6, PointOutcome::kTrueNegative);
  const std::string plane = outcome_plane(outcomes, points);
  EXPECT_EQ(plane, std::string("\x03\x0b\x0b\x0b\x03\x0b"));
}

TEST(PointPlanes, HoldRadialVelocitiesInCentimetresPerSecond) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(velocity_planes(std::vector<float>{2.58F, -0.01F, kNan, 400.0F}),
            std::string("\x02\xff\x00\x00\x01\xff\x80\x80", 8));
  EXPECT_EQ(velocity_planes({}), "");
}

TEST(PointPlanes, HoldScoresByteByByte) {
  // 3.0F is 0x40400000, 1.0F is 0x3f800000.
  EXPECT_EQ(score_planes(std::vector<float>{3.0F, 1.0F}),
            std::string("\x00\x00\x00\x00\x40\x80\x40\x3f", 8));
  EXPECT_EQ(score_planes({}), "");
}

TEST(DynamicScores, AreOneFiniteNumberPerPoint) {
  const std::vector<float> scores = {0, 7, -1.5F};
  const std::string bytes(format_dynamic_scores(scores));
  constexpr auto kFloat32 = ScoreNumbers::kFloat32;
  EXPECT_EQ(parse_dynamic_scores(bytes, 3, kFloat32, "f"), scores);
  EXPECT_TRUE(parse_dynamic_scores("", 0, kFloat32, "f").empty());
  EXPECT_THROW(parse_dynamic_scores(bytes, 2, kFloat32, "f"), DataError);
  const std::vector<float> bad = {1, std::numeric_limits<float>::quiet_NaN()};
  EXPECT_THROW(parse_dynamic_scores(format_dynamic_scores(bad), 2, kFloat32, "f"), DataError);
}

TEST(DynamicScores, OfTheFirstFormatAreWholeNumbers) {
  const std::string bytes({0, 0, 0, 0, 7, 0, 0, 0, 0x2f, 0x0d, 0, 0});
  EXPECT_EQ(parse_dynamic_scores(bytes, 3, ScoreNumbers::kInt32, "f"),
            (std::vector<float>{0, 7, 3375}));
}

TEST(Reasons, AreOneKnownBytePerPoint) {
  const std::vector<Reason> reasons = {Reason::kNone, Reason::kFeet, Reason::kArrived};
  const std::string bytes(format_reasons(reasons));
  EXPECT_EQ(bytes, std::string("\x00\x04\x01", 3));
  EXPECT_EQ(parse_reasons(bytes, 3, "f"), reasons);
  EXPECT_THROW(parse_reasons(bytes, 4, "f"), DataError);
  EXPECT_THROW(parse_reasons("\x06", 1, "f"), DataError);
  EXPECT_THROW(parse_reasons("\xff", 1, "f"), DataError);
}

TEST(CompressedText, IsZlibInBase64) {
  EXPECT_EQ(compressed_text(""), "eJwDAAAAAAE=");
  EXPECT_EQ(compressed_text("a"), "eJxLBAAAYgBi");
  EXPECT_EQ(compressed_text("mosbench"), "eJzLzS9OSs1LzgAADyEDUA==");
}

TEST(ReportAsset, IsOnePageWithAPlaceForTheContent) {
  const auto [before, behind] = parts_of_page(report_asset());
  EXPECT_TRUE(before.starts_with("<!doctype html>"));
  EXPECT_NE(before.find("three.js authors"), std::string_view::npos);
  EXPECT_NE(behind.find("</html>"), std::string_view::npos);
  // Nothing in it may be fetched.
  for (const char* fetched : {"<link", " src=", "@import", "url(http"}) {
    EXPECT_EQ(before.find(fetched), std::string_view::npos) << fetched;
  }
}

}  // namespace
}  // namespace mosbench
