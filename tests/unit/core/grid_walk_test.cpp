#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/voxel/ray_runs.hpp"

namespace mosbench {
namespace {

constexpr double kSize_m = 0.25;

Voxel voxel_at_position(const Eigen::Vector3d& p_m) {
  const auto index = [](double c) { return static_cast<std::int32_t>(std::floor(c / kSize_m)); };
  return {index(p_m.x()), index(p_m.y()), index(p_m.z())};
}

bool less(const Voxel& a, const Voxel& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// The voxels between all crossings of a line with borders, without following it.
std::vector<Voxel> voxels_between_borders(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d line = to - from;
  std::vector<double> shares{0, 1};
  for (int axis = 0; axis < 3; ++axis) {
    for (int border = -100; border <= 100; ++border) {
      const double share = (border * kSize_m - from[axis]) / line[axis];
      if (share > 0 && share < 1) shares.push_back(share);
    }
  }
  std::ranges::sort(shares);
  std::vector<Voxel> voxels;
  for (std::size_t i = 1; i < shares.size(); ++i) {
    voxels.push_back(voxel_at_position(from + line * ((shares[i - 1] + shares[i]) / 2)));
  }
  return voxels;
}

Eigen::Vector3d somewhere(std::mt19937& random) {
  const auto coordinate = [&] { return static_cast<double>(random()) / 4294967296.0 * 16 - 8; };
  const double x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

std::vector<Voxel> voxels_of(const VoxelList& list) {
  std::vector<Voxel> voxels;
  for (std::size_t i = 0; i < list.blocks.size(); ++i) {
    for_each_cell(list.masks[i],
                  [&](std::uint32_t cell) { voxels.push_back(voxel_at(list.blocks[i], cell)); });
  }
  std::ranges::sort(voxels, less);
  return voxels;
}

BlockIndex lay_out_test_window(RayWindow& window, RayWindow::BytesAlong bytes) {
  return lay_out_around({{-40, -40, -40}, {40, 40, 40}}, window, bytes);
}

/// A window of 64 voxels around 0, and what is cast in it.
struct CastWindow {
  explicit CastWindow(RayWindow::BytesAlong along = RayWindow::BytesAlong::kX) : bytes(along) {}

  RayWindow::BytesAlong bytes;
  RayWindow window;
  BlockIndex first = lay_out_test_window(window, bytes);
  WindowBits bits{window};
  ThreadPool pool{1};

  std::uint64_t bit_of(const Voxel& v) const {
    const Voxel corner = voxel_at(first, 0);
    return bits.at({v.x - corner.x, v.y - corner.y, v.z - corner.z});
  }
  ExactRay ray(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const Eigen::Vector3d line = to - from;
    const Voxel start = voxel_at_position(from);
    return {BorderCrossings(from, line / line.norm(), start, kSize_m), line.norm(), bit_of(start),
            bit_of(voxel_at_position(to)), static_cast<std::uint32_t>(line.lpNorm<1>() / kSize_m)};
  }
  std::vector<Voxel> take() { return voxels_of(collect({&window, 1}, first, pool)); }
};

class WindowBitsOfEitherAxis : public testing::TestWithParam<RayWindow::BytesAlong> {};
INSTANTIATE_TEST_SUITE_P(Axes, WindowBitsOfEitherAxis,
                         testing::Values(RayWindow::BytesAlong::kX, RayWindow::BytesAlong::kY));

TEST_P(WindowBitsOfEitherAxis, MoveToTheNeighboursInEveryDirection) {
  const CastWindow cast(GetParam());
  for (const Voxel& v : {Voxel{0, 0, 0}, Voxel{7, -8, 31}, Voxel{-33, 15, -1}, Voxel{31, 31, 7}}) {
    EXPECT_EQ(cast.bits.next(cast.bit_of(v), 0, false), cast.bit_of({v.x + 1, v.y, v.z}));
    EXPECT_EQ(cast.bits.next(cast.bit_of(v), 1, false), cast.bit_of({v.x, v.y + 1, v.z}));
    EXPECT_EQ(cast.bits.next(cast.bit_of(v), 2, false), cast.bit_of({v.x, v.y, v.z + 1}));
    EXPECT_EQ(cast.bits.next(cast.bit_of(v), 0, true), cast.bit_of({v.x - 1, v.y, v.z}));
    EXPECT_EQ(cast.bits.next(cast.bit_of(v), 1, true), cast.bit_of({v.x, v.y - 1, v.z}));
    EXPECT_EQ(cast.bits.next(cast.bit_of(v), 2, true), cast.bit_of({v.x, v.y, v.z - 1}));
  }
}

TEST_P(WindowBitsOfEitherAxis, AreThoseOfTheVoxelsThatAreCollected) {
  CastWindow cast(GetParam());
  std::vector<Voxel> voxels{{-40, 3, 12}, {-1, -1, -1}, {0, 1, 2}, {5, 38, -7}, {6, 2, 1}};
  WindowPen pen(cast.window);
  for (const Voxel& v : voxels) pen.mark(cast.bit_of(v));
  CastWindow turned(GetParam() == RayWindow::BytesAlong::kX ? RayWindow::BytesAlong::kY
                                                            : RayWindow::BytesAlong::kX);
  turned.window.copy_turned(cast.window);
  EXPECT_EQ(cast.take(), voxels);
  EXPECT_EQ(turned.take(), voxels);
  EXPECT_TRUE(turned.take().empty());
}

TEST(ExactRays, CrossTheVoxelsBetweenTheBorders) {
  std::mt19937 random(3);
  CastWindow cast;
  for (int round = 0; round < 40; ++round) {
    std::vector<ExactRay> rays;
    std::vector<Voxel> expected, but_ends;
    const int count = round % 20 + 1;  // also groups that are not full
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d from = somewhere(random), to = somewhere(random);
      const std::vector<Voxel> voxels = voxels_between_borders(from, to);
      ASSERT_GT(voxels.size(), 1U);
      expected.insert(expected.end(), voxels.begin(), voxels.end());
      but_ends.insert(but_ends.end(), voxels.begin(), voxels.end() - 1);
      rays.push_back(cast.ray(from, to));
    }
    for (auto* voxels : {&expected, &but_ends}) {
      std::ranges::sort(*voxels, less);
      voxels->erase(std::ranges::unique(*voxels).begin(), voxels->end());
    }
    RayWindow nothing_hit;
    lay_out_around({{-40, -40, -40}, {40, 40, 40}}, nothing_hit);
    std::vector<ExactRay> again = rays;
    cast_exact(rays, RayEnd::kAtHit, nothing_hit, 0, cast.window);
    EXPECT_EQ(cast.take(), expected);
    cast_exact(again, RayEnd::kBeforeEnd, nothing_hit, 0, cast.window);
    EXPECT_EQ(cast.take(), but_ends);
  }
}

TEST(ExactRays, StopAtAHitAndGoOnBeyondIt) {
  CastWindow cast;
  RayWindow hits;
  lay_out_around({{-40, -40, -40}, {40, 40, 40}}, hits);
  WindowPen(hits).mark(cast.bit_of({3, 0, 0}));
  for (const int beyond : {0, 1, 2}) {
    std::vector<ExactRay> rays{cast.ray({0.1, 0.1, 0.1}, {2, 0.1, 0.1})};
    cast_exact(rays, RayEnd::kAtHit, hits, beyond, cast.window);
    std::vector<Voxel> expected;
    for (std::int32_t x = 0; x <= 3 + beyond; ++x) expected.push_back({x, 0, 0});
    EXPECT_EQ(cast.take(), expected);
  }
}

/// Random rays from one place, those that go farthest along the axis of a window's bytes.
std::vector<ExactRay> rays_along(const CastWindow& cast, const Eigen::Vector3d& from,
                                 std::mt19937& random) {
  const Eigen::Index along = cast.bytes == RayWindow::BytesAlong::kX ? 0 : 1;
  std::vector<ExactRay> rays;
  for (std::size_t count = 1 + random() % 40; rays.size() < count;) {
    const Eigen::Vector3d somewhere_else = somewhere(random);
    Eigen::Vector3d to;
    // The middles of voxels, as methods cast to: many lines through edges where `from` is a corner.
    for (int i = 0; i < 3; ++i) to[i] = (std::floor(somewhere_else[i] / kSize_m) + 0.5) * kSize_m;
    Eigen::Index longest = 0;
    (to - from).cwiseAbs().maxCoeff(&longest);
    if (longest == along) rays.push_back(cast.ray(from, to));
  }
  return rays;
}

/// Casts what cast_runs leaves, too. Returns how many rays that were.
std::size_t cast_all_runs(const std::vector<ExactRay>& rays, const RayWindow& hits, int beyond,
                          RayWindow& window) {
  std::vector<ExactRay> doubtful;
  cast_runs(rays, hits, beyond, window, doubtful);
  cast_exact(doubtful, RayEnd::kAtHit, hits, beyond, window);
  return doubtful.size();
}

TEST_P(WindowBitsOfEitherAxis, RunsMarkWhatExactRaysMark) {
  std::mt19937 random(11);
  CastWindow cast(GetParam()), expected(GetParam());
  std::size_t all = 0, at_corners = 0, doubtful = 0, doubtful_at_corners = 0;
  for (int round = 0; round < 300; ++round) {
    const bool at_corner = round % 5 == 4;
    const Eigen::Vector3d from = at_corner ? Eigen::Vector3d(0.5, -0.25, 1) : somewhere(random);
    const std::vector<ExactRay> rays = rays_along(cast, from, random);
    CastWindow hits(GetParam());
    WindowPen pen(hits.window);
    for (int i = 0; i < round % 4 * 200; ++i) {
      pen.mark(cast.bit_of(voxel_at_position(somewhere(random))));
    }
    const int beyond = round % 3;
    cast_exact(rays, RayEnd::kAtHit, hits.window, beyond, expected.window);
    const std::size_t left = cast_all_runs(rays, hits.window, beyond, cast.window);
    ASSERT_EQ(cast.take(), expected.take()) << "round " << round;
    (at_corner ? at_corners : all) += rays.size();
    (at_corner ? doubtful_at_corners : doubtful) += left;
  }
  EXPECT_GT(all, 3000U);
  EXPECT_LT(doubtful, all / 100);
  EXPECT_GT(doubtful_at_corners, at_corners / 10);
}

TEST_P(WindowBitsOfEitherAxis, ARunEndsAtItsFirstHit) {
  CastWindow cast(GetParam());
  const bool along_x = GetParam() == RayWindow::BytesAlong::kX;
  const auto voxel = [&](std::int32_t along) {
    return along_x ? Voxel{along, 0, 0} : Voxel{0, along, 0};
  };
  const auto place = [&](double along_m) {
    return along_x ? Eigen::Vector3d(along_m, 0.1, 0.1) : Eigen::Vector3d(0.1, along_m, 0.1);
  };
  CastWindow hits(GetParam());
  WindowPen pen(hits.window);
  for (const int hit : {3, 5, -4, -6}) pen.mark(cast.bit_of(voxel(hit)));
  for (const int sign : {-1, 1}) {
    for (const int beyond : {0, 1, 2}) {
      EXPECT_EQ(cast_all_runs({cast.ray(place(0.1), place(sign * 2.1))}, hits.window, beyond,
                              cast.window),
                0U);
      std::vector<Voxel> expected;
      const int last = sign > 0 ? 3 + beyond : -4 - beyond;
      for (int i = std::min(0, last); i <= std::max(0, last); ++i) expected.push_back(voxel(i));
      EXPECT_EQ(cast.take(), expected) << "sign " << sign << " beyond " << beyond;
    }
  }
}

}  // namespace
}  // namespace mosbench
