#include "core/voxel/directions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "core/base/multiarch.hpp"
#include "core/base/simd_lanes.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kFewestReturns = 1000;
constexpr int kSectors = 720;
// Two returns of one beam in a sector, or of a comb seen through noise.
constexpr double kSameBeamDeg = 0.05;
// Quartiles of spacings differ by a factor of 4.8 at random (exponential, beyond kSameBeamDeg,
// too), of 3.6 to 6.1 with simulated rosettes, and of 1.7 with HDL-64E's comb, which is half as
// dense at its lower end.
constexpr double kScatterOfRandom = 2.5;

/// Returns the spacings of elevations that follow one another in a sector of azimuth.
std::vector<double> spacings_deg(std::span<const BeamDirection> directions) {
  std::vector<std::vector<double>> sectors(kSectors);
  for (const BeamDirection& direction : directions) {
    const auto sector = static_cast<std::size_t>(direction.azimuth_deg / 360 * kSectors);
    sectors[std::min<std::size_t>(sector, kSectors - 1)].push_back(direction.elevation_deg);
  }
  std::vector<double> spacings;
  for (std::vector<double>& elevations : sectors) {
    std::ranges::sort(elevations);
    for (std::size_t i = 1; i < elevations.size(); ++i) {
      const double spacing = elevations[i] - elevations[i - 1];
      if (spacing > kSameBeamDeg) spacings.push_back(spacing);
    }
  }
  return spacings;
}

Direction direction_of(const Eigen::Vector3d& p) {
  const double range_m = std::sqrt((p.x() * p.x() + p.y() * p.y()) + p.z() * p.z());
  if (!(range_m > 0)) return {};
  // Single precision is a ten-thousandth of the spacing of beams, and several times as fast.
  const auto sine = static_cast<float>(p.z() / range_m);
  return {static_cast<float>(range_m),
          std::atan2(static_cast<float>(p.y()), static_cast<float>(p.x())),
          std::asin(std::clamp(sine, -1.0F, 1.0F))};
}

constexpr float kPi = 3.14159274F;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The numbers that the neighbours of a query share, in eight lanes.
struct Box {
  FloatLanes nearest_m = FloatLanes{} + kInfinity;
  FloatLanes right_rad = FloatLanes{} + kInfinity, left_rad = FloatLanes{} - kInfinity;
  FloatLanes down_rad = FloatLanes{} + kInfinity, up_rad = FloatLanes{} - kInfinity;
};

template <typename Lanes>
inline __attribute__((always_inline)) Lanes lesser(const Lanes& a, const Lanes& b) {
  return a < b ? a : b;
}
template <typename Lanes>
inline __attribute__((always_inline)) Lanes greater(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}

float least(const FloatLanes& lanes) {
  float value = lanes[0];
  for (std::size_t i = 1; i < kLanes; ++i) value = std::min(value, lanes[i]);
  return value;
}
float greatest(const FloatLanes& lanes) { return -least(-lanes); }

/// The query that candidates are compared with.
struct Comparison {
  Direction query;
  float angle_sq_rad2;
  float least_m;  ///< a neighbour that is not so much farther away decides the query
};

/// Candidates first to last - 1 of the arrays of a grid, which can be read a few farther.
struct Candidates {
  const float *range_m, *bearing_rad, *elevation_rad;
  std::uint32_t first, last;
};

/// Adds the neighbours among the candidates to the box. Returns whether one of them is a veto.
MOSBENCH_MULTIARCH bool add_neighbours(const Candidates& candidates, const Comparison& with,
                                       Box& box) {
  const FloatLanes infinity = FloatLanes{} + kInfinity;
  for (std::uint32_t i = candidates.first; i < candidates.last; i += kLanes) {
    const auto range = load<FloatLanes>(candidates.range_m + i);
    const FloatLanes apart = load<FloatLanes>(candidates.bearing_rad + i) - with.query.bearing_rad;
    const FloatLanes b = apart > kPi ? apart - 2 * kPi : (apart < -kPi ? apart + 2 * kPi : apart);
    const FloatLanes e = load<FloatLanes>(candidates.elevation_rad + i) - with.query.elevation_rad;
    const IntLanes position = IntLanes{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::int32_t>(i);
    const IntLanes near = (b * b + e * e <= with.angle_sq_rad2) &
                          (position < static_cast<std::int32_t>(candidates.last));
    box.nearest_m = lesser(box.nearest_m, near ? range : infinity);
    box.right_rad = lesser(box.right_rad, near ? b : infinity);
    box.left_rad = greater(box.left_rad, near ? b : -infinity);
    box.down_rad = lesser(box.down_rad, near ? e : infinity);
    box.up_rad = greater(box.up_rad, near ? e : -infinity);
    if (bits_of(IntLanes(box.nearest_m - with.query.range_m < with.least_m)) != 0) return true;
  }
  return false;
}

}  // namespace

std::vector<BeamDirection> beam_directions(std::span<const Point> points, double min_range_m) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  std::vector<BeamDirection> directions;
  for (const Point& point : points) {
    const double x = point.x, y = point.y, z = point.z;
    const double range_m = std::sqrt(x * x + y * y + z * z);
    if (!std::isfinite(range_m) || range_m <= min_range_m || range_m == 0) continue;
    const double azimuth_deg = std::atan2(-y, x) * kDegrees;
    directions.push_back(
        {azimuth_deg < 0 ? azimuth_deg + 360 : azimuth_deg, std::asin(z / range_m) * kDegrees});
  }
  return directions;
}

double quantile(std::vector<double>& values, double share) {
  const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

std::optional<RowSpacing> row_spacing(std::span<const BeamDirection> directions) {
  if (directions.size() < kFewestReturns) return std::nullopt;
  std::vector<double> spacings = spacings_deg(directions);
  if (spacings.size() < kFewestReturns / 10) return std::nullopt;
  const double upper = quantile(spacings, 0.75) - kSameBeamDeg;
  const double lower = quantile(spacings, 0.25) - kSameBeamDeg;
  const bool is_regular = upper < kScatterOfRandom * lower;
  return RowSpacing{quantile(spacings, 0.5), is_regular};
}

std::vector<Direction> directions_of(std::span<const Point> points,
                                     const Pose& reference_from_sensor, const RangeWindow& window,
                                     ThreadPool& pool) {
  std::vector<Direction> directions(points.size());
  pool.for_ranges(points.size(), 2048, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d p(points[i].x, points[i].y, points[i].z);
      const double range_sq_m2 = (p.x() * p.x() + p.y() * p.y()) + p.z() * p.z();
      // NaN fails both.
      const bool takes_part = range_sq_m2 > window.above_m * window.above_m &&
                              range_sq_m2 <= window.up_to_m * window.up_to_m;
      if (takes_part) directions[i] = direction_of(reference_from_sensor * p);
    }
  });
  return directions;
}

void NeighbourAngle::measure(std::span<const Point> points, double min_range_m) {
  if (is_measured_ || least_rows_ == 0) return;
  const std::optional<RowSpacing> spacing = row_spacing(beam_directions(points, min_range_m));
  if (!spacing) return;
  is_measured_ = true;
  const double least_rad =
      std::min(least_rows_ * spacing->degrees / 180 * std::numbers::pi, kWidestAngle_rad);
  if (!spacing->is_regular || least_rad <= rad_) return;
  rad_ = least_rad;
  row_deg_ = spacing->degrees;
}

std::vector<std::string> NeighbourAngle::remarks() const {
  if (row_deg_ == 0) return {};
  std::ostringstream text;
  text << "The neighbour angle was widened to " << rad_ << " rad, as the sensor's rows are "
       << row_deg_ << " degrees apart.";
  return {text.str()};
}

DirectionGrid::DirectionGrid(std::span<const Direction> points, double neighbour_angle_rad) {
  const auto angle = static_cast<float>(neighbour_angle_rad);
  angle_sq_rad2_ = angle * angle;
  // A little wider than alpha, so that rounding never puts a neighbour two cells away.
  const double width_rad = neighbour_angle_rad * 1.001;
  columns_ = static_cast<std::uint32_t>(2 * static_cast<double>(kPi) / width_rad);
  columns_per_rad_ = static_cast<float>(columns_ / (2 * static_cast<double>(kPi)));
  rows_per_rad_ = static_cast<float>(1 / width_rad);
  rows_ = row_of(kPi / 2) + 2;

  std::vector<std::uint32_t> cells(points.size());
  first_.resize(std::size_t{rows_} * columns_ + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].range_m == 0) continue;
    cells[i] = cell_of(row_of(points[i].elevation_rad), column_of(points[i].bearing_rad));
    ++first_[cells[i] + 1];
  }
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  const std::size_t size = first_.back() + kLanes;
  range_m_.resize(size);
  bearing_rad_.resize(size);
  elevation_rad_.resize(size);
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].range_m == 0) continue;
    const std::uint32_t place = next[cells[i]]++;
    range_m_[place] = points[i].range_m;
    bearing_rad_[place] = points[i].bearing_rad;
    elevation_rad_[place] = points[i].elevation_rad;
  }
}

/// Rows 0 and the last stay empty, so that each row has two beside it.
std::uint32_t DirectionGrid::row_of(float elevation_rad) const {
  return 1 + static_cast<std::uint32_t>((elevation_rad + kPi / 2) * rows_per_rad_);
}

std::uint32_t DirectionGrid::column_of(float bearing_rad) const {
  const auto column = static_cast<std::uint32_t>((bearing_rad + kPi) * columns_per_rad_);
  return std::min(column, columns_ - 1);
}

Look DirectionGrid::look(const Direction& query, float least_m) const {
  if (query.range_m == 0) return {};
  const Comparison with{query, angle_sq_rad2_, least_m};
  Box box;
  const auto vetoed = [&](std::uint32_t first_cell, std::uint32_t last_cell) {
    const Candidates candidates{range_m_.data(), bearing_rad_.data(), elevation_rad_.data(),
                                first_[first_cell], first_[last_cell + 1]};
    return add_neighbours(candidates, with, box);
  };
  const std::uint32_t own_row = row_of(query.elevation_rad);
  const std::uint32_t column = column_of(query.bearing_rad);
  // Most queries are decided by the first row: a surface is where one was.
  for (const std::uint32_t row : {own_row, own_row - 1, own_row + 1}) {
    const std::uint32_t from = cell_of(row, column == 0 ? 0 : column - 1);
    const std::uint32_t to = cell_of(row, std::min(column + 1, columns_ - 1));
    if (vetoed(from, to)) return {Look::Finding::kOccupied, 0};
    const std::uint32_t other_end = column == 0 ? columns_ - 1 : 0;
    if ((column == 0 || column == columns_ - 1) &&
        vetoed(cell_of(row, other_end), cell_of(row, other_end))) {
      return {Look::Finding::kOccupied, 0};
    }
  }
  const bool inside = least(box.right_rad) <= 0 && greatest(box.left_rad) >= 0 &&
                      least(box.down_rad) < 0 && greatest(box.up_rad) > 0;
  if (!inside) return {};
  return {Look::Finding::kFree, least(box.nearest_m) - query.range_m};
}

std::size_t DirectionGrid::memory_bytes() const {
  return first_.capacity() * sizeof(std::uint32_t) +
         (range_m_.capacity() + bearing_rad_.capacity() + elevation_rad_.capacity()) *
             sizeof(float);
}

std::vector<Look> looks_at(std::span<const Direction> queries, const DirectionGrid& reference,
                           float least_m, ThreadPool& pool) {
  std::vector<Look> looks(queries.size());
  pool.for_ranges(queries.size(), 1024, [&](std::size_t begin, std::size_t end, unsigned) {
    for (std::size_t i = begin; i < end; ++i) looks[i] = reference.look(queries[i], least_m);
  });
  return looks;
}

}  // namespace mosbench
