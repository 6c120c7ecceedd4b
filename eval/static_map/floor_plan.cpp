#include "eval/static_map/floor_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

/// Cells of a picture, a byte each.
constexpr std::int64_t kMostCells = std::int64_t{1} << 29;
/// map_server's values for what a cell is.
constexpr unsigned char kOccupied = 0, kUnknown = 205, kFree = 254;

using FloorCell = std::pair<std::int64_t, std::int64_t>;

FloorCell floor_cell_of(double x_m, double y_m, double side_m) {
  return {static_cast<std::int64_t>(std::floor(x_m / side_m)),
          static_cast<std::int64_t>(std::floor(y_m / side_m))};
}

/// Heights of the ground, by square.
class Ground {
 public:
  explicit Ground(const StaticMap& map) {
    map.for_each([&](const MapPoint& point) {
      const Eigen::Vector3d& at_m = point.position_map_m;
      heights_m_[floor_cell_of(at_m.x(), at_m.y(), kSquare_m)].push_back(
          static_cast<float>(at_m.z()));
    });
    for (auto& [square, heights_m] : heights_m_) heights_m = {lowest_m(heights_m)};
  }

  /// The lowest in the square of a point and those beside it.
  double below_m(const Eigen::Vector3d& at_m) const {
    const auto [x, y] = floor_cell_of(at_m.x(), at_m.y(), kSquare_m);
    float lowest_m = std::numeric_limits<float>::infinity();
    for (std::int64_t i = x - 1; i <= x + 1; ++i) {
      for (std::int64_t k = y - 1; k <= y + 1; ++k) {
        const auto square = heights_m_.find({i, k});
        if (square != heights_m_.end()) lowest_m = std::min(lowest_m, square->second.front());
      }
    }
    return lowest_m;
  }

 private:
  static constexpr double kSquare_m = 1.0;

  /// Mirrors show a few points below the ground: the lowest height has others just above it.
  static float lowest_m(std::vector<float>& heights_m) {
    constexpr std::size_t kOthers = 3;
    constexpr float kJustAbove_m = 0.3F;
    std::ranges::sort(heights_m);
    for (std::size_t i = 0; i + kOthers < heights_m.size(); ++i) {
      if (heights_m[i + kOthers] <= heights_m[i] + kJustAbove_m) return heights_m[i];
    }
    return heights_m.front();
  }

  std::map<FloorCell, std::vector<float>> heights_m_;
};

/// Returns how high the sensor is above the ground around it, in a scan that is turned like the
/// map.
double height_of_sensor_m(const std::vector<Eigen::Vector3d>& rays_m) {
  constexpr double kAround_m = 15.0, kShareBelowGround = 0.02;
  std::vector<double> depths_m;
  for (const Eigen::Vector3d& ray_m : rays_m) {
    if (ray_m.head<2>().norm() < kAround_m) depths_m.push_back(-ray_m.z());
  }
  if (depths_m.empty()) return 0.0;
  return quantile(depths_m, 1.0 - kShareBelowGround, QuantileRule::kNearestRank);
}

/// Returns how far from the sensor a ray leaves the heights in a robot's way, or hits something,
/// and 0 if it never is at them.
double free_until_m(const Eigen::Vector3d& ray_m, double sensor_m, const HeightRange& heights) {
  const double length_m = ray_m.head<2>().norm();
  if (sensor_m < heights.min_m || sensor_m > heights.max_m) return 0.0;
  if (ray_m.z() == 0.0) return length_m;
  const double limit_m = ray_m.z() > 0.0 ? heights.max_m : heights.min_m;
  return length_m * std::min(1.0, (limit_m - sensor_m) / ray_m.z());
}

}  // namespace

FreeCells::Place FreeCells::place_of(std::int64_t x, std::int64_t y) {
  const auto in = [](std::int64_t i) { return ((i % kSide) + kSide) % kSide; };
  return {{(x - in(x)) / kSide, (y - in(y)) / kSide},
          static_cast<std::size_t>(in(x)*kSide + in(y))};
}

bool FreeCells::has(std::int64_t x, std::int64_t y) const {
  const Place place = place_of(x, y);
  const auto square = squares_.find(place.square);
  return square != squares_.end() && square->second.test(place.in_square);
}

void FreeCells::add(const JudgedScan& scan, const RangeGate& range) {
  constexpr std::size_t kDirections = 1440;
  std::vector<Eigen::Vector3d> rays_m;
  for (const Point& point : scan.frame.points) {
    if (!is_return(point) || !range.contains(range_m(point))) continue;
    rays_m.emplace_back(scan.frame.map_from_sensor.linear() * position_of(point));
  }
  const double sensor_m = height_of_sensor_m(rays_m);
  std::vector<double> free_m(kDirections, 0.0);
  const auto width_rad = 2.0 * std::numbers::pi / static_cast<double>(kDirections);
  for (const Eigen::Vector3d& ray_m : rays_m) {
    const double turns = std::atan2(ray_m.y(), ray_m.x()) / width_rad;
    const auto direction = static_cast<std::size_t>(std::floor(turns) + kDirections);
    double& until_m = free_m[direction % kDirections];
    until_m = std::max(until_m, free_until_m(ray_m, sensor_m, heights_));
  }
  const Eigen::Vector3d from_m = scan.frame.map_from_sensor.translation();
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double towards_rad = (static_cast<double>(i) + 0.5) * width_rad;
    for (double at_m = 0.0; at_m + cell_m_ <= free_m[i]; at_m += 0.7 * cell_m_) {
      const auto [x, y] = floor_cell_of(from_m.x() + at_m * std::cos(towards_rad),
                                        from_m.y() + at_m * std::sin(towards_rad), cell_m_);
      const Place place = place_of(x, y);
      squares_[place.square].set(place.in_square);
    }
  }
}

FloorPlan floor_plan(const StaticMap& map, const FreeCells& free, const HeightRange& heights,
                     const std::filesystem::path& image) {
  const double cell_m = map.config().voxel_m;
  std::int64_t west = std::numeric_limits<std::int64_t>::max(), south = west;
  std::int64_t east = std::numeric_limits<std::int64_t>::min(), north = east;
  const auto include = [&](std::int64_t x, std::int64_t y) {
    west = std::min(west, x), south = std::min(south, y);
    east = std::max(east, x), north = std::max(north, y);
  };
  map.for_each([&](const MapPoint& point) {
    const auto [x, y] = floor_cell_of(point.position_map_m.x(), point.position_map_m.y(), cell_m);
    include(x, y);
  });
  free.for_each_square(include);
  if (west > east) throw DataError(image, "would be empty", "a map with points");
  const std::int64_t width = east - west + 1, height = north - south + 1;
  if (width > kMostCells / height) {
    throw DataError(
        image, fmt::format("would have {} x {} cells", width, height),
        fmt::format("at most {} cells: a larger --voxel, or fewer --scans", kMostCells));
  }
  FloorPlan plan;
  plan.pgm = fmt::format("P5\n{} {}\n255\n", width, height);
  const std::size_t head = plan.pgm.size();
  plan.pgm.append(static_cast<std::size_t>(width * height), static_cast<char>(kUnknown));
  const auto value_at = [&](std::int64_t x, std::int64_t y) -> char& {
    return plan.pgm[head + static_cast<std::size_t>((north - y) * width + x - west)];
  };
  for (std::int64_t y = south; y <= north; ++y) {
    for (std::int64_t x = west; x <= east; ++x) {
      if (free.has(x, y)) value_at(x, y) = static_cast<char>(kFree);
    }
  }
  const Ground ground(map);
  std::vector<FloorCell> occupied;
  map.for_each([&](const MapPoint& point) {
    const Eigen::Vector3d& at_m = point.position_map_m;
    const double above_m = at_m.z() - ground.below_m(at_m);
    const FloorCell cell = floor_cell_of(at_m.x(), at_m.y(), cell_m);
    if (above_m > heights.max_m) return;
    if (above_m < heights.min_m) {
      value_at(cell.first, cell.second) = static_cast<char>(kFree);
    } else {
      occupied.push_back(cell);
    }
  });
  for (const auto& [x, y] : occupied) value_at(x, y) = static_cast<char>(kOccupied);
  for (std::size_t i = head; i < plan.pgm.size(); ++i) {
    plan.occupied += plan.pgm[i] == static_cast<char>(kOccupied) ? 1U : 0U;
    plan.free += plan.pgm[i] == static_cast<char>(kFree) ? 1U : 0U;
  }
  plan.yaml = fmt::format(
      "image: {}\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.196\n",
      image.filename().string(), cell_m, static_cast<double>(west) * cell_m,
      static_cast<double>(south) * cell_m);
  return plan;
}

}  // namespace mosbench
