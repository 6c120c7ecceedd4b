#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/tsdf/integration.hpp"
#include "core/tsdf/tsdf_map.hpp"

/// Numbers worked by hand from the published settings of Dynablox.
namespace mosbench::tsdf {
namespace {

/// The sensor of the authors' default.yaml.
constexpr SensorModel kOusterOs1{
    .rows = 64, .columns = 2048, .down_deg = -33.22222 / 2, .up_deg = 33.22222 / 2};

TEST(TsdfSensor, MeetsAVoxelWithSoManyRays) {
  const double rays = kOusterOs1.rays_per_voxel_at_1m(0.2);
  EXPECT_NEAR(rays, 1439.0770, 1e-4);
  EXPECT_NEAR(rays / 25, 57.563, 1e-3);
  EXPECT_NEAR(rays / 400, 3.5977, 1e-4);
}

TEST(TsdfAngles, AreThoseOfTheLibraryWithinTheirRounding) {
  for (int i = 0; i < 20000; ++i) {
    const double angle = (i + 0.25) / 20000 * 2 * std::numbers::pi;
    const Point point{static_cast<float>(7 * std::cos(angle)),
                      static_cast<float>(-7 * std::sin(angle)), 1, 0};
    const ImagePlace place = place_in_image(kOusterOs1, point);
    const double phi = std::atan2(-double{point.y}, double{point.x}) / (2 * std::numbers::pi);
    ASSERT_NEAR(place.column, 2048 * (phi < 0 ? phi + 1 : phi), 2e-4);
    const double elevation = std::atan(1.0 / 7) / std::numbers::pi * 180;
    ASSERT_NEAR(place.row, 63 * (0.5 - elevation / 33.22222), 2e-5);
  }
  EXPECT_EQ(place_in_image(kOusterOs1, {0, 0, 0, 0}).column, 0.0F);
}

std::pair<int, int> pixel_of(const Point& point) {
  ThreadPool pool(1);
  const std::int32_t pixel = pixels_of({&point, 1}, kOusterOs1, pool).pixels.front();
  return pixel == kNoPixel ? std::pair{-1, -1} : std::pair{pixel / 2048, pixel % 2048};
}

TEST(TsdfPixels, AreTruncatedTowardZeroAndRejectedAtTheSeam) {
  using Pixel = std::pair<int, int>;
  const Pixel none{-1, -1};
  EXPECT_EQ(pixel_of({1, 0, 0, 0}), none);
  EXPECT_EQ(pixel_of({1, -1, 0, 0}), Pixel(31, 256));
  EXPECT_EQ(pixel_of({-1, -1, 0, 0}), Pixel(31, 768));
  EXPECT_EQ(pixel_of({-1, 1, 0, 0}), Pixel(31, 1280));
  EXPECT_EQ(pixel_of({1, 1, 0, 0}), Pixel(31, 1792));
  const auto at_elevation = [](double degrees) {
    const double radians = degrees / 180 * std::numbers::pi;
    return Point{-static_cast<float>(std::cos(radians)), 0.1F,
                 static_cast<float>(std::sin(radians)), 0};
  };
  EXPECT_EQ(pixel_of(at_elevation(16.5)).first, 0);
  EXPECT_EQ(pixel_of(at_elevation(16.61 + 0.4)).first, 0) << "up to a row above the field of view";
  EXPECT_EQ(pixel_of(at_elevation(16.61 + 0.7)), none);
  EXPECT_EQ(pixel_of(at_elevation(-16.5)).first, 62);
  EXPECT_EQ(pixel_of(at_elevation(-17.3)), none);
  EXPECT_EQ(pixel_of({0, 0, 0, 0}), none);
  EXPECT_EQ(pixel_of({std::nanf(""), 1, 1, 0}), none);
  EXPECT_EQ(pixel_of({INFINITY, 1, 1, 0}), none);
}

TEST(TsdfRangeImage, KeepsTheNearestReturnAndHidesBehindOneTooNear) {
  const SensorModel sensor{.rows = 2, .columns = 8, .down_deg = -10, .up_deg = 10};
  const ScanPixels pixels{{3, 3, 3, 4, 4, kNoPixel, 12}, {7, 5, 6, 9, 0.3F, 1, 8}};
  const RangeImage image = range_image(pixels, sensor, 0.5F);
  EXPECT_EQ(image.at(0, 3), 5);
  EXPECT_EQ(image.at(0, 4), 0);
  EXPECT_EQ(image.at(1, 4), 8);
  EXPECT_EQ(image.ranges_m.size(), 24U) << "an empty row below the last one";
}

TEST(TsdfDepth, IsLinearButForEmptyPixelsAndEdges) {
  RangeImage image{.rows = 2, .columns = 2, .ranges_m = {4, 6, 5, 7, 0, 0}};
  EXPECT_FLOAT_EQ(depth_at(image, {0.5F, 0.25F}, 10), 5.0F);
  EXPECT_EQ(depth_at(image, {0.5F, 0.25F}, 0.2F), 4.0F) << "an edge: the nearest";
  image.ranges_m = {4, 0, 5, 0, 0, 0};
  EXPECT_FLOAT_EQ(depth_at(image, {0.5F, 0.25F}, 10), 4.5F) << "the left column alone";
  image.ranges_m = {0, 6, 0, 0, 0, 0};
  EXPECT_EQ(depth_at(image, {0.5F, 0.25F}, 10), 6.0F);
  image.ranges_m = {0, 0, 0, 0, 0, 0};
  EXPECT_EQ(depth_at(image, {0.5F, 0.25F}, 10), 0.0F);
  image.ranges_m = {4, 6, 5, 7, 0, 0};
  EXPECT_FLOAT_EQ(depth_at(image, {1.0F, 0.5F}, 10), 6.0F) << "below the last row nothing is";
}

/// A voxel at 5 m that is at a surface in some frames, and then free: frames until it counts as
/// free.
int frames_until_free(int frames_at_surface) {
  const Config config;
  ThreadPool pool(1);
  const VoxelGrid grid{.voxel_size_m = 0.2};
  TsdfMap map(0.3F);
  const Voxel voxel{25, 0, 0};  // its centre is 5 m along -x of the sensor
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(10.1, 0.1, 0.1);
  const std::vector<std::uint32_t> slots = map.touch({wide_of(block_of(voxel))}).slots;
  RangeImage image{.rows = 64, .columns = 2048, .ranges_m = {}};
  const auto see = [&](float depth_m) {
    image.ranges_m.assign(65 * 2048, depth_m);
    integrate(map, slots, grid, {image, kOusterOs1, pose}, config, pool);
  };
  for (int i = 0; i < frames_at_surface; ++i) see(5.0F);
  const MapBlock& block = *map.find(block_of(voxel));
  EXPECT_TRUE(block.near_surface.test(cell_of(voxel)));
  for (int frames = 1; frames < 100; ++frames) {
    see(15.0F);
    // The mean of 3 free and 1 occupied frame is 0.3 m but for rounding.
    if (map.numbers[block.numbers].distances_m[cell_of(voxel)] > 0.3F - 1e-6F) return frames;
  }
  return -1;
}

TEST(TsdfIntegration, TakesSoManyFramesToFreeAVoxelAtASurface) {
  EXPECT_EQ(frames_until_free(1), 3);
  EXPECT_EQ(frames_until_free(5), 15);
  EXPECT_EQ(frames_until_free(20), 25) << "the weight is limited";
  EXPECT_EQ(frames_until_free(100), 25);
}

TEST(TsdfRays, MeetEveryBlockThatPointsOnThemLieIn) {
  std::mt19937 random(3);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  pose.translation() = Eigen::Vector3d(-11.3, 4.1, 2.2);
  const RayLimits limits{.wide_block_m = 3.2,
                         .grid_origin_m = Eigen::Vector3d(-12.8, 0, 0),
                         .min_range_m = 0.5,
                         .max_range_m = 25,
                         .beyond_m = 0.4};
  ThreadPool pool(2);
  RayBlocksScratch scratch;
  for (int round = 0; round < 200; ++round) {
    const std::vector<Point> points{{static_cast<float>(uniform(-15, 15)),
                                     static_cast<float>(uniform(-15, 15)),
                                     static_cast<float>(uniform(-5, 5)), 0}};
    const Eigen::Vector3d point(points[0].x, points[0].y, points[0].z);
    const auto range_m = static_cast<float>(point.norm());
    const auto blocks = ray_blocks(points, {{0}, {range_m}}, pose, limits, scratch, pool);
    std::size_t inside = 0;
    for (int step = 0; step <= 1000; ++step) {
      const Eigen::Vector3d at =
          pose * (point * (1 + 0.4 / range_m) * step / 1000.0) - limits.grid_origin_m;
      const auto cell = [&](int axis) { return static_cast<int>(std::floor(at[axis] / 3.2)); };
      // Beside a corner of blocks rounding decides which one is met.
      const Eigen::Vector3d from_border =
          (at / 3.2 - (at / 3.2).array().round().matrix()).cwiseAbs();
      if (from_border.minCoeff() < 1e-3) continue;
      inside += std::ranges::count(blocks, BlockIndex{cell(0), cell(1), cell(2)}) == 1;
      ASSERT_EQ(std::ranges::count(blocks, BlockIndex{cell(0), cell(1), cell(2)}), 1);
    }
    ASSERT_GT(inside, 900U);
    ASSERT_LE(blocks.size(), 25U);
  }
}

TEST(TsdfSensor, IsMeasuredFromItsComb) {
  std::vector<Point> points;
  std::mt19937 random(4);
  for (int column = 0; column < 1800; ++column) {
    for (int beam = 0; beam < 16; ++beam) {
      const double e = (-15.0 + 2 * beam) / 180 * std::numbers::pi;
      const double a = (column + 0.5) / 1800 * 2 * std::numbers::pi;
      const double range_m = 3 + static_cast<double>(random() % 1000) / 50;
      points.push_back({static_cast<float>(range_m * std::cos(e) * std::cos(a)),
                        static_cast<float>(range_m * std::cos(e) * std::sin(a)),
                        static_cast<float>(range_m * std::sin(e)), 0});
    }
  }
  const SensorModel sensor = measured_sensor(points, {}).value();
  EXPECT_TRUE(sensor.has_beams);
  EXPECT_EQ(sensor.rows, 16);
  EXPECT_EQ(sensor.columns, 1800);
  EXPECT_NEAR(sensor.down_deg, -14.5, 1e-3)
      << "beams lie a quarter of a row below their rows' edges";
  EXPECT_NEAR(sensor.up_deg, 15.5, 1e-3);
  Config config;
  config.range_image_columns = 900;
  EXPECT_EQ(measured_sensor(points, config)->columns, 900) << "what is set is kept";
  EXPECT_EQ(measured_sensor(std::span(points).first(900), {}), std::nullopt);
}

/// Returns scattered over 70 degrees around an azimuth, which rises to the left, and 76 degrees of
/// elevation, 9 m away.
std::vector<Point> rosette_around(double azimuth_deg, int returns = 24000) {
  std::vector<Point> points;
  std::mt19937 random(4);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  for (int i = 0; i < returns; ++i) {
    const double e = uniform(-38, 38) / 180 * std::numbers::pi;
    const double a = uniform(azimuth_deg - 35, azimuth_deg + 35) / 180 * std::numbers::pi;
    points.push_back({static_cast<float>(9 * std::cos(e) * std::cos(a)),
                      static_cast<float>(9 * std::cos(e) * std::sin(a)),
                      static_cast<float>(9 * std::sin(e)), 0});
  }
  return points;
}

TEST(TsdfSensor, HasAReturnPerPixelWhereDirectionsAreScattered) {
  for (const int returns : {24000, 96000}) {
    const SensorModel sensor = measured_sensor(rosette_around(0, returns), {}).value();
    EXPECT_FALSE(sensor.has_beams) << returns;
    const double pixel_deg = std::sqrt(70.0 * 76 / returns);
    EXPECT_NEAR(sensor.rows * pixel_deg, 76, 2) << returns;
    EXPECT_NEAR(sensor.columns * pixel_deg, 360, 4) << returns;
  }
}

TEST(TsdfSensor, SeesAllThatARosetteSees) {
  ThreadPool pool(1);
  for (const double azimuth_deg : {0.0, 90.0, 170.0, -120.0}) {
    const std::vector<Point> points = rosette_around(azimuth_deg);
    const SensorModel sensor = measured_sensor(points, {}).value();
    EXPECT_NEAR(std::remainder(sensor.first_deg + azimuth_deg - 180, 360), 0, 1) << azimuth_deg;
    const std::vector<std::int32_t> pixels = pixels_of(points, sensor, pool).pixels;
    const auto seen = static_cast<double>(points.size()) -
                      static_cast<double>(std::ranges::count(pixels, kNoPixel));
    EXPECT_GT(seen / static_cast<double>(points.size()), 0.99) << azimuth_deg;
    const double middle_rad = azimuth_deg / 180 * std::numbers::pi;
    const ImagePlace ahead = place_in_image(
        sensor,
        {static_cast<float>(std::cos(middle_rad)), static_cast<float>(std::sin(middle_rad)), 0, 0});
    EXPECT_NEAR(ahead.column / static_cast<float>(sensor.columns), 0.5, 0.004) << azimuth_deg;
  }
}

}  // namespace
}  // namespace mosbench::tsdf
