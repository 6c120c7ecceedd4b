#include "eval/answer/picture.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "eval/report/scan_picture.hpp"

namespace mosbench {
namespace {

constexpr Colour kBlack{0, 0, 0};
constexpr Colour kRed{200, 0, 0};

std::size_t pixels_of(const Picture& picture, Colour colour) {
  std::size_t count = 0;
  for (std::size_t y = 0; y < picture.height(); ++y) {
    for (std::size_t x = 0; x < picture.width(); ++x) count += picture.at(x, y) == colour ? 1U : 0U;
  }
  return count;
}

TEST(Picture, FillsADiscAboutItsMiddle) {
  Picture picture(40, 40, kBlack);
  picture.disc(20.0, 20.0, 8.0, kRed);
  EXPECT_EQ(picture.at(20, 20), kRed);
  EXPECT_EQ(picture.at(20, 13), kRed);
  EXPECT_EQ(picture.at(20, 8), kBlack);
  EXPECT_EQ(picture.at(27, 27), kBlack);
}

TEST(Picture, DrawsNothingOutside) {
  Picture picture(10, 10, kBlack);
  picture.disc(-100.0, 5.0, 3.0, kRed);
  picture.disc(1e9, 1e9, 3.0, kRed);
  picture.text(-500, 3, "far", kRed);
  picture.rectangle(10, 10, 5, 5, kRed);
  EXPECT_EQ(pixels_of(picture, kBlack), 100U);
}

TEST(Picture, DrawsLinesOfTheirWidthAndCutsThemAtTheEdge) {
  Picture picture(40, 40, kBlack);
  picture.line(10.0, 5.0, 10.0, 35.0, 4.0, kRed);
  EXPECT_EQ(picture.at(9, 20), kRed);
  EXPECT_EQ(picture.at(10, 6), kRed);
  EXPECT_EQ(picture.at(14, 20), kBlack);
  EXPECT_EQ(picture.at(10, 2), kBlack);
  picture.line(-1e6, 20.0, 1e6, 20.0, 2.0, kRed);
  EXPECT_EQ(picture.at(39, 20), kRed);
  picture.line(25.0, 30.0, 25.0, 30.0, 6.0, kRed);
  EXPECT_EQ(picture.at(25, 30), kRed);
}

TEST(LineCharts, ShowEveryPointOfEveryCurveAndKeepShapes) {
  const Colour blue{0, 0, 200};
  const LineChart chart{
      "c", "x", "y", true, {{"r", kRed, {{0, 0}, {30, 0}}}, {"b", blue, {{0, 10}, {0, 0}}}}};
  const Picture picture = line_charts(std::array{chart, chart, LineChart{}}, 400);
  EXPECT_EQ(picture.width(), 1200U);
  EXPECT_EQ(picture.height(), 400U);
  // Below the curves' names.
  const auto extent = [&](Colour colour, std::size_t from_x) {
    std::size_t low_x = 9999, high_x = 0, low_y = 9999, high_y = 0;
    for (std::size_t y = 70; y < 400; ++y) {
      for (std::size_t x = from_x; x < from_x + 400; ++x) {
        if (picture.at(x, y) != colour) continue;
        low_x = std::min(low_x, x);
        high_x = std::max(high_x, x);
        low_y = std::min(low_y, y);
        high_y = std::max(high_y, y);
      }
    }
    return std::array<double, 2>{static_cast<double>(high_x) - static_cast<double>(low_x),
                                 static_cast<double>(high_y) - static_cast<double>(low_y)};
  };
  for (const std::size_t from_x : {0U, 400U}) {
    ASSERT_GT(extent(kRed, from_x)[0], 150);
    EXPECT_LT(extent(kRed, from_x)[1], 4);
    EXPECT_NEAR(extent(blue, from_x)[1] / extent(kRed, from_x)[0], 1.0 / 3, 0.03);
  }
}

TEST(LineCharts, AreDrawnOfPointsFarAwayAndOfNumbersThatDoNotFit) {
  for (const double far : {1e15, 1e200, 1e308}) {
    const LineChart chart{"c", "x", "y", true, {{"r", kRed, {{far, 0}, {far, 1}, {-far, 2}}}}};
    const LineChart still{"c", "x", "y", true, {{"r", kRed, {{far, 0}, {far, 0}}}}};
    EXPECT_EQ(line_charts(std::array{chart, still}, 300).width(), 600U);
  }
}

TEST(LineCharts, HaveTheirMarksBelow) {
  const std::array charts = {LineChart{.title = "t", .x_label = "x", .y_label = "y", .curves = {}}};
  const std::array<std::string, 2> marks = {"SIMULATED data", "a: all 3 poses are equal"};
  const Picture plain = line_charts(charts, 300), marked = line_charts(charts, 300, marks);
  ASSERT_EQ(marked.height(), plain.height() + 2 * (Picture::kGlyphHeight + 4));
  const auto inked = [&](std::size_t from, std::size_t to) {
    std::size_t pixels = 0;
    for (std::size_t y = from; y < to; ++y) {
      for (std::size_t x = 0; x < marked.width(); ++x) {
        if (!(marked.at(x, y) == palette(false).background)) ++pixels;
      }
    }
    return pixels;
  };
  EXPECT_GT(inked(300, 324), 100U);
  EXPECT_GT(inked(324, 348), 100U);
}

TEST(LineCharts, BreakMarksThatAreWiderThanTheyAre) {
  const std::array charts = {LineChart{.title = "t", .x_label = "x", .y_label = "y", .curves = {}}};
  const std::array<std::string, 1> marks = {"28 letters are in each line, and these go on below"};
  EXPECT_EQ(line_charts(charts, 300, marks).height(), 300U + 2 * (Picture::kGlyphHeight + 4));
}

TEST(Wrapped, BreaksAtBlanksAndLongWordsAnywhere) {
  const std::array<std::string, 3> lines = {"two words", "", "/path/of/many letters"};
  EXPECT_THAT(wrapped(lines, 6),
              testing::ElementsAre("two", "words", "", "/path/", "of/man", "y", "letter", "s"));
  EXPECT_THAT(wrapped(lines, 100), testing::ElementsAreArray(lines));
}

TEST(Picture, WritesLettersThatDifferAndNothingForABlank) {
  const auto lit = [](const char* text) {
    Picture picture(Picture::kGlyphWidth, Picture::kGlyphHeight, kBlack);
    picture.text(0, 0, text, {255, 255, 255});
    return picture.width() * picture.height() - pixels_of(picture, kBlack);
  };
  EXPECT_EQ(lit(" "), 0U);
  EXPECT_GT(lit("."), 0U);
  EXPECT_GT(lit("M"), 3 * lit("."));
  EXPECT_EQ(lit("\xff"), lit("?"));
}

TEST(Picture, IsAPngFileOfTheSamePixels) {
  Picture picture(30, 20, kBlack);
  picture.rectangle(3, 4, 5, 6, kRed);
  const std::string bytes = picture.png();
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()), 0);
  ASSERT_EQ(image.width, 30U);
  ASSERT_EQ(image.height, 20U);
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
  const std::size_t inside = 3 * (30 * 5 + 4);
  EXPECT_EQ(pixels[inside], 200);
  EXPECT_EQ(pixels[0], 0);
}

TEST(Palette, IsThatOfThePage) {
  EXPECT_EQ(palette(false).outcomes.at(0).colour, (Colour{0x00, 0x72, 0xB2}));
  EXPECT_EQ(palette(true).outcomes.at(1).name, "false positive");
  EXPECT_EQ(palette(true).outcomes.at(1).name_without_truth, "false positive");
  EXPECT_EQ(palette(true).outcomes.at(4).name_without_truth, "static");
  EXPECT_EQ(palette(false).outcomes.size(), OutcomeCounts{}.size());
  EXPECT_EQ(palette(false).reasons.size(), kReasonCount);
  EXPECT_EQ(palette(false).reasons.at(4).name, "feet");
  ASSERT_EQ(palette(false).scenes.size(), kErrorSceneNames.size());
  for (std::size_t i = 1; i < kErrorSceneNames.size(); ++i) {
    EXPECT_EQ(palette(true).scenes[i].name, kErrorSceneNames.at(i));
  }
}

/// One point per outcome, ahead of the sensor and apart from each other.
JudgedScan row_of_outcomes() {
  JudgedScan scan;
  for (std::size_t i = 0; i < 6; ++i) {
    scan.frame.points.push_back({4.0F + static_cast<float>(i), 0.0F, 0.0F, 0.0F});
    scan.outcomes.push_back(static_cast<PointOutcome>(i));
  }
  return scan;
}

TEST(ScanPicture, DrawsEachPointWhereItIsInTheColourOfItsOutcome) {
  ScanPictureOptions options;
  options.size_pixels = 1000;
  options.range_m = 20.0;
  const Picture picture = scan_picture(row_of_outcomes(), options);
  const Palette colours = palette(false);
  for (const std::size_t i : {0U, 1U, 2U, 5U}) {
    const std::size_t up = 500 - 25 * (4 + i);
    EXPECT_EQ(picture.at(500, up), colours.outcomes[i].colour) << i;
  }
}

TEST(ScanPicture, DrawsEachPointInTheColourOfItsReasonWhenAskedTo) {
  ScanPictureOptions options;
  options.range_m = 20.0;
  options.by_reason = true;
  JudgedScan scan = row_of_outcomes();
  for (const int reason : {1, 2, 3, 4, 1, 1}) scan.reasons.push_back(static_cast<Reason>(reason));
  const Picture picture = scan_picture(scan, options);
  const Palette colours = palette(false);
  for (const std::size_t i : {0U, 1U, 2U, 3U}) {
    EXPECT_EQ(picture.at(500, 500 - 25 * (4 + i)), colours.reasons[i + 1].colour) << i;
  }
}

TEST(ScanPicture, DrawsWrongPointsInTheColoursOfTheirScenesWhenAskedTo) {
  ScanPictureOptions options;
  options.range_m = 20.0;
  for (const int scene : {0, 5, 6, 0, 0, 0}) {
    options.scenes.push_back(static_cast<ErrorScene>(scene));
  }
  const Picture picture = scan_picture(row_of_outcomes(), options);
  const Palette colours = palette(false);
  EXPECT_EQ(picture.at(500, 500 - 25 * 5), colours.scenes[5].colour);
  EXPECT_EQ(picture.at(500, 500 - 25 * 6), colours.scenes[6].colour);
  EXPECT_EQ(pixels_of(picture, colours.outcomes[0].colour), 0U);
}

TEST(ScanView, PutsWhatIsAheadAboveAndWhatIsLeftToTheLeftFromAboveAndFromBehind) {
  for (const std::optional<double> azimuth_rad : {std::optional<double>(), std::optional(0.0)}) {
    const ScanView view({azimuth_rad}, 20.0, 1000.0);
    const ViewedPoint sensor = view.seen({0, 0, 0}).value();
    EXPECT_NEAR(sensor.x, 500.0, 1e-9);
    EXPECT_NEAR(sensor.y, 500.0, 1e-9);
    EXPECT_NEAR(sensor.scale, 1.0, 1e-12);
    EXPECT_LT(view.seen({5, 0, 0}).value().y, 490.0);
    EXPECT_LT(view.seen({0, 5, 0}).value().x, 490.0);
  }
  // From above, heights do not show.
  const ScanView above({}, 20.0, 1000.0);
  EXPECT_EQ(above.seen({5, 3, 2}).value().y, above.seen({5, 3, 0}).value().y);
}

TEST(ScanView, OfAnOrbitTurnsWithTheAzimuth) {
  // Looking to the left: what is left of the sensor is far, what is ahead of it at the right.
  const ScanView left({std::numbers::pi / 2.0}, 20.0, 1000.0);
  const ViewedPoint far = left.seen({0, 10, 0}).value(), near = left.seen({0, -10, 0}).value();
  EXPECT_GT(far.distance_m, near.distance_m);
  EXPECT_LT(far.scale, 1.0);
  EXPECT_GT(near.scale, 1.0);
  EXPECT_GT(left.seen({10, 0, 0}).value().x, 510.0);
  EXPECT_LT(left.seen({0, 0, 2}).value().y, 490.0);
  // The camera is 1.6 ranges away, 30 degrees above.
  const Eigen::Vector3d camera(0.0, -32.0 * std::cos(std::numbers::pi / 6.0), 16.0);
  EXPECT_FALSE(left.seen(camera));
  EXPECT_FALSE(left.seen(2.0 * camera));
  EXPECT_NEAR(left.seen({0, 0, 0}).value().distance_m, 32.0, 1e-9);
}

TEST(ScanPicture, DrawsBoxesWithTheirSpeeds) {
  JudgedScan scan = row_of_outcomes();
  ScanPictureOptions options;
  options.range_m = 20.0;
  const std::size_t without = pixels_of(scan_picture(scan, options), palette(false).text);
  MovingBox box;
  box.size_m = {4.0, 2.0, 1.5};
  box.map_from_box.translation() = Eigen::Vector3d(0.0, 10.0, 0.0);
  options.boxes = {box};
  const Picture drawn = scan_picture(scan, options);
  // The left side of the box, 11 m to the left of the sensor.
  EXPECT_EQ(drawn.at(500 - 275, 500), palette(false).text);
  const std::size_t plain = pixels_of(drawn, palette(false).text);
  EXPECT_GT(plain, without + 100);
  options.boxes[0].size_m = {0.1, 0.1, 0.1};  // of a large one the speed veils some
  const std::size_t small = pixels_of(scan_picture(scan, options), palette(false).text);
  options.boxes[0].velocity_m_s = Eigen::Vector3d(3.0, 4.0, 0.0);
  EXPECT_GT(pixels_of(scan_picture(scan, options), palette(false).text), small + 20);
  options.boxes[0].size_m = box.size_m;
  options.orbit_rad = 1.0;
  EXPECT_GT(pixels_of(scan_picture(scan, options), palette(false).text), without + 100);
}

TEST(ScanPicture, WritesRangesOverPoints) {
  ScanPictureOptions options;
  options.range_m = 20.0;
  const JudgedScan none;
  JudgedScan scan;
  for (int i = 0; i < 400; ++i) {  // where the ring of 5 m is named
    scan.frame.points.push_back({4.9F - 0.02F * static_cast<float>(i / 20),
                                 -0.1F - 0.1F * static_cast<float>(i % 20), 0, 0});
    scan.outcomes.push_back(PointOutcome::kFalsePositive);
  }
  const Colour ink = palette(false).outcomes[3].colour;
  const std::size_t written = pixels_of(scan_picture(none, options), ink);
  EXPECT_GT(written, 30U);
  EXPECT_EQ(pixels_of(scan_picture(scan, options), ink), written);
}

TEST(ScanPicture, HasLargerTextWhereItIsLarger) {
  ScanPictureOptions options;
  options.title = {"a title"};
  const std::size_t once = pixels_of(scan_picture({}, options), palette(false).text);
  options.size_pixels = 1600;
  EXPECT_GT(pixels_of(scan_picture({}, options), palette(false).text), 3 * once);
}

TEST(ScanPicture, WritesLongLinesOfItsTitleToTheirEndOrSaysThatThereIsMore) {
  const auto drawn = [](std::size_t size_pixels, const std::string& title) {
    ScanPictureOptions options;
    options.size_pixels = size_pixels;
    options.title = {title};
    return scan_picture({}, options).png();
  };
  const std::string doubt(20, 'x'), longer = doubt + std::string(400, 'y');
  for (const std::size_t size : {200U, 1000U}) {
    EXPECT_NE(drawn(size, doubt + " scan 1"), drawn(size, doubt + " scan 2")) << size;
  }
  EXPECT_NE(drawn(1000, longer + "1"), drawn(1000, longer + "2"));
  EXPECT_EQ(drawn(200, longer + "1"), drawn(200, longer + "2"));
}

TEST(ScanPicture, PutsSpeedsThatWouldOverlapAboveOneAnother) {
  ScanPictureOptions options;
  options.range_m = 20.0;
  MovingBox box;
  box.size_m = {4.0, 2.0, 1.5};
  box.map_from_box.translation() = Eigen::Vector3d(0.0, 10.0, 0.0);
  box.velocity_m_s = Eigen::Vector3d(3.0, 4.0, 0.0);
  options.boxes = {box};
  const std::size_t one = pixels_of(scan_picture({}, options), palette(false).text);
  options.boxes.push_back(box);
  EXPECT_GT(pixels_of(scan_picture({}, options), palette(false).text), one + 20);
}

TEST(ScanPicture, DrawsAScanWithoutPointsAndWithImpossibleOnes) {
  JudgedScan scan;
  EXPECT_EQ(scan_picture(scan, {}).width(), 1000U);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  scan.frame.points = {{kNan, 0, 0, 0}, {1e30F, 0, 0, 0}, {0, 0, 0, 0}};
  scan.outcomes.assign(3, PointOutcome::kFalsePositive);
  const Picture picture = scan_picture(scan, {});
  ScanPictureOptions orbit;
  orbit.orbit_rad = 2.0;
  EXPECT_EQ(scan_picture(scan, orbit).width(), 1000U);
  // Only in the key to the colours.
  EXPECT_LT(pixels_of(picture, palette(false).outcomes[1].colour), 120U);
}

}  // namespace
}  // namespace mosbench
