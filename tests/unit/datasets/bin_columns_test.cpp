#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/simulator/scene.hpp"
#include "datasets/simulator/simulator.hpp"
#include "datasets/text/errors.hpp"
#include "tests/shared_folder.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<Point> simulated_points(std::string_view scene, std::string_view sensor) {
  std::vector<Point> points = built_in_simulator(scene, sensor, 3).frame(2).points;
  points.resize(points.size() / 420 * 420);  // of all numbers of columns
  return points;
}

/// Returns the points with as many columns: after the first four a ring, a time and two numbers.
std::string with_columns(const std::vector<Point>& points, std::size_t columns) {
  std::vector<float> numbers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& p = points[i];
    const auto at = static_cast<float>(i);
    const float time_s = 0.1F * at / static_cast<float>(points.size());
    const std::array all = {p.x, p.y, p.z, p.intensity, static_cast<float>(i % 32), time_s, at};
    numbers.insert(numbers.end(), all.begin(), all.begin() + static_cast<std::ptrdiff_t>(columns));
  }
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)};
}

/// Expects that no part of a scan of four columns is taken for one of others.
void expect_four(std::string_view bytes) {
  EXPECT_EQ(other_bin_columns(bytes, 4), std::nullopt);
  for (const std::size_t points : {64U, 70U, 105U, 210U, 420U, 2100U}) {
    const std::size_t size = points * sizeof(Point);
    for (std::size_t at = 0; at + size <= bytes.size(); at += std::max(size, bytes.size() / 8)) {
      const std::string_view part = bytes.substr(at / sizeof(Point) * sizeof(Point), size);
      EXPECT_EQ(other_bin_columns(part, 4), std::nullopt) << points << " points from " << at;
    }
  }
}

TEST(BinColumns, AreOfLittleEndianFloat32OrRefused) {
  for (const std::size_t columns : {3U, 4U, 5U, 7U}) {
    std::string bytes = with_columns(simulated_points("street", "vlp-16"), columns);
    EXPECT_EQ(other_bin_numbers(bytes), "");
    std::string wide;
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(float)) {
      float number = 0;
      std::memcpy(&number, bytes.data() + at, sizeof(number));
      const double same = number;
      wide.append(reinterpret_cast<const char*>(&same), sizeof(same));
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                   bytes.begin() + static_cast<std::ptrdiff_t>(at + sizeof(float)));
    }
    EXPECT_EQ(other_bin_numbers(bytes), "big-endian float32");
    EXPECT_EQ(other_bin_numbers(wide), "float64");
    // Whole numbers among them, as labels, are no sign of either.
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i % 4 == 0 ? i : 0);
    EXPECT_EQ(other_bin_numbers(bytes), "");
  }
  const TempFolder folder;
  const auto points = simulated_points("street", "vlp-16");
  std::string bytes = with_columns(points, 4);
  for (auto at = bytes.begin(); at != bytes.end(); at += 4) std::reverse(at, at + 4);
  folder.write("d/0.bin", bytes);
  EXPECT_THAT(message_of<DataError>([&] { open_dataset(folder / "d", {}); }),
              HasSubstr("0.bin: holds big-endian float32, expected little-endian float32"));
}

TEST(BinColumns, AreFoundWhereTheyAreNotFour) {
  const std::vector<Point> points = simulated_points("street", "vlp-16");
  ASSERT_GT(points.size(), 10'000U);
  for (const std::size_t columns : {3U, 5U, 6U, 7U}) {
    EXPECT_EQ(other_bin_columns(with_columns(points, columns), 4), columns);
    EXPECT_EQ(other_bin_columns(with_columns(points, columns), columns), std::nullopt);
  }
}

TEST(BinColumns, AreFoundInAnyOrderOfThePoints) {
  std::vector<Point> points = simulated_points("street", "vlp-16");
  std::mt19937 random(20240601);
  std::shuffle(points.begin(), points.end(), random);
  EXPECT_EQ(other_bin_columns(with_columns(points, 5), 4), 5U);
  EXPECT_EQ(other_bin_columns(with_columns(points, 4), 4), std::nullopt);
}

TEST(BinColumns, AreFourInEverySimulatedScanAndPartsOfIt) {
  for (const SceneSummary& scene : built_in_scenes()) {
    SCOPED_TRACE(scene.name);
    expect_four(with_columns(simulated_points(scene.name, "vlp-16"), 4));
  }
  for (const std::string_view sensor : {"avia", "aeva", "os1-64"}) {
    SCOPED_TRACE(sensor);
    expect_four(with_columns(simulated_points("street", sensor), 4));
  }
}

TEST(BinColumns, AreFourInOddScans) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (const float intensity_scale : {0.0F, 1.0F, 65535.0F, 1e30F}) {
    std::vector<Point> points(420);
    for (Point& p : points) {
      p = {normal(random), normal(random), normal(random), intensity_scale * normal(random)};
    }
    points[7].x = std::numeric_limits<float>::quiet_NaN();
    points[9].intensity = std::numeric_limits<float>::infinity();
    // Neighbours of two beams that see near and far in turn differ more than any others.
    for (std::size_t i = 0; i < points.size(); i += 2) points[i].x += 90.0F;
    EXPECT_EQ(other_bin_columns(with_columns(points, 4), 4), std::nullopt) << intensity_scale;
  }
  EXPECT_EQ(other_bin_columns(with_columns(std::vector<Point>(420), 4), 4), std::nullopt);
  EXPECT_EQ(other_bin_columns("", 4), std::nullopt);
}

/// Scans in which few numbers make up most of the mean.
TEST(BinColumns, AreFourWhereFewPointsTellMuch) {
  std::normal_distribution<float> normal;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    for (const std::size_t size : {210U, 420U, 4200U, 21'000U}) {
      for (const unsigned return_of : {1U, 2U, 3U, 10U, 30U, 100U, 500U}) {
        std::vector<Point> zero(size), missing(size, {nan, nan, nan, 0});
        std::vector<Point> bright(size);
        for (std::size_t i = 0; i < size; ++i) {
          const Point p = {20 * normal(random), 20 * normal(random), normal(random),
                           normal(random)};
          const bool returns = random() % return_of == 0;
          if (returns) zero[i] = missing[i] = p;
          bright[i] = p;
          if (returns && return_of >= 100) bright[i].intensity = 1e8F;
        }
        for (const std::vector<Point>& points : {zero, missing, bright}) {
          EXPECT_EQ(other_bin_columns(with_columns(points, 4), 4), std::nullopt)
              << size << " points, one return of " << return_of << ", seed " << seed;
        }
      }
    }
  }
}

TEST(BinColumns, AreFourInEveryRealScan) {
  const auto real = shared_folder() / "real";
  if (!std::filesystem::exists(real)) GTEST_SKIP() << real << " is not there";
  std::size_t scans = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(real)) {
    if (entry.path().extension() != ".bin") continue;
    SCOPED_TRACE(entry.path());
    expect_four(read_file(entry.path()));
    ++scans;
  }
  EXPECT_GT(scans, 0U);
}

TEST(BinColumns, OfThreeHaveNoIntensity) {
  const std::vector<Point> points =
      parse_bin(with_columns({{1, 2, 3, 4}, {5, 6, 7, 8}}, 3), 3, "f");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].z, 7.0F);
  EXPECT_EQ(points[1].intensity, 0.0F);
}

class ScansOfFiveColumns : public testing::Test {
 protected:
  ScansOfFiveColumns() {
    const std::string bytes = with_columns(simulated_points("street", "vlp-16"), 5);
    for (const char* file : {"flat/0.bin", "kitti/velodyne/000000.bin"}) folder_.write(file, bytes);
    for (const char* file : {"flat/poses.txt", "kitti/poses.txt"}) {
      folder_.write(file, "1 0 0 0 0 1 0 0 0 0 1 0\n");
    }
  }

  TempFolder folder_;
};

TEST_F(ScansOfFiveColumns, AreRefusedUntilTheirNumberIsTold) {
  for (const char* place : {"flat", "kitti", "flat/0.bin"}) {
    const auto data = folder_ / place;
    EXPECT_THAT(message_of<DataError>([&] { open_dataset(data, {}); }),
                AllOf(HasSubstr("0.bin: seems to hold 5 float32 per point rather than 4"),
                      HasSubstr("expected bin_columns 5, or 4 if it is as it should be")));
    const Dataset five = open_dataset(data, {.reading = {.bin_columns = 5}});
    const Frame frame = five.sequences.at(0)->read(0);
    EXPECT_EQ(frame.points.size(), simulated_points("street", "vlp-16").size());
    const Dataset four = open_dataset(data, {.reading = {.bin_columns = 4}});
    EXPECT_EQ(four.sequences.at(0)->read(0).points.size(), frame.points.size() * 5 / 4);
  }
}

}  // namespace
}  // namespace mosbench
