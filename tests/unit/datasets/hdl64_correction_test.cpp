#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "datasets/formats/bin_file.hpp"
#include "datasets/layouts/dataset.hpp"
#include "datasets/sequence/corrected_sequence.hpp"
#include "tests/temp_folder.hpp"

namespace mosbench {
namespace {

using testing::Contains;
using testing::Key;
using testing::Not;
using testing::Pair;

TEST(Hdl64Correction, RaisesEveryPointByItsAngleAndKeepsItsRange) {
  for (const Point& point : {Point{10, 0, -1, 0.5F}, Point{-3, 4, 2, 1}, Point{0, -50, 0, 0}}) {
    const Eigen::Vector3d before(point.x, point.y, point.z);
    const Eigen::Vector3d axis = before.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d expected =
        Eigen::AngleAxisd(0.205 * std::acos(-1.0) / 180.0, axis) * before;
    const Point raised = raised_by_hdl64_correction(point);
    EXPECT_LT((Eigen::Vector3d(raised.x, raised.y, raised.z) - expected).norm(), 5e-6);
    EXPECT_EQ(raised.intensity, point.intensity);
    EXPECT_GT(raised.z, point.z);
  }
  const Point missing = raised_by_hdl64_correction({0, 0, 0, 0});
  EXPECT_EQ(missing.z, 0.0F);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(raised_by_hdl64_correction({nan, 1, 2, 3}).x));
}

TEST(Hdl64Correction, IsOffUnlessToldAndStated) {
  const TempFolder folder;
  write_bin(folder / "s/velodyne/000000.bin", std::vector<Point>{{10, 0, -1, 0.5F}});
  folder.write("s/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const Dataset plain = open_dataset(folder / "s", {});
  EXPECT_EQ(plain.sequences.at(0)->read(0).points.at(0).z, -1.0F);
  EXPECT_THAT(members_of(plain.sequences.at(0)->reading()), Not(Contains(Key("hdl64_correction"))));
  const Dataset raised = open_dataset(folder / "s", {.reading = {.hdl64_correction = true}});
  EXPECT_NEAR(raised.sequences.at(0)->read(0).points.at(0).z, -0.9642144, 1e-6);
  EXPECT_THAT(members_of(raised.sequences.at(0)->reading()),
              Contains(Pair("hdl64_correction", "points raised by 0.205 degrees")));
}

}  // namespace
}  // namespace mosbench
