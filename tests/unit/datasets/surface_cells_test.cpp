#include "datasets/doctor/surface_cells.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace mosbench {
namespace {

TEST(SurfaceCells, AlignEndsForPosesWithoutEnd) {
  std::vector<Eigen::Vector3d> wall_m;
  for (int i = 0; i < 200; ++i) wall_m.emplace_back(2.0, 0.02 * i, 0.01 * (i % 20));
  const SurfaceCells cells(wall_m);
  for (const double far_m : {1e9, 1e308, std::numeric_limits<double>::infinity(),
                             std::numeric_limits<double>::quiet_NaN()}) {
    Pose start = Pose::Identity();
    start.translation().x() = far_m;
    EXPECT_EQ(align(cells, wall_m, start).overlap, 0.0) << far_m;
  }
  EXPECT_GT(align(cells, wall_m, Pose::Identity()).overlap, 0.5);
}

}  // namespace
}  // namespace mosbench
