#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <mosbench/scan.hpp>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

/// Single voxels in hash maps, and what reference.cpp does with voxels and numbers alone. Shares no
/// code with core/voxel.
namespace mosbench::hmm_mos::reference {

struct Voxel {
  int x = 0, y = 0, z = 0;
  bool operator==(const Voxel&) const = default;
};

struct Hash {
  std::size_t operator()(const Voxel& v) const {
    const auto mix = [](int c) { return static_cast<std::size_t>(static_cast<unsigned>(c)); };
    return (mix(v.x) * 73856093U) ^ (mix(v.y) * 19349669U) ^ (mix(v.z) * 83492791U);
  }
};

template <typename Value>
using MapOf = std::unordered_map<Voxel, Value, Hash>;
using SetOf = std::unordered_set<Voxel, Hash>;

enum Occupancy { kUnobserved, kOccupied, kFree };

/// A voxel of the map M.
struct Cell {
  std::array<double, 3> x = {1, 0, 0};  // belief: unobserved, occupied, free
  Occupancy state = kUnobserved;        // S
  int last_change = 0, last_seen = 0;
};

/// A voxel of P'_M within the range limit.
struct ScanVoxel {
  int votes = 0, sum = 0;  // K_m * P'_chg, L^dyn
  bool beside_unknown = false, dynamic = false, from_region = false;
};

/// A voxel of the dynamic region.
struct RegionVoxel {
  bool dynamic = false, high_confidence = false, beside_unknown = false;
  int neighbours = 0, last_seen = 0;
};

inline double squared(double value) { return value * value; }
inline double norm_sq(double x, double y, double z) { return squared(x) + squared(y) + squared(z); }

/// Returns floor(p / size). Throws std::range_error for what no int holds with room for neighbours.
inline Voxel voxel_at(const Eigen::Vector3d& p_m, double size_m) {
  const Eigen::Array3d index = (p_m.array() / size_m).floor();
  if (!(index.abs().maxCoeff() < 1e9)) {
    throw std::range_error("coordinate: its voxel index overflows, expected one below 1e9");
  }
  return {static_cast<int>(index.x()), static_cast<int>(index.y()), static_cast<int>(index.z())};
}

/// Calls visit(neighbour) for the (2 radius + 1)^3 voxels around v, itself included.
template <typename Visit>
void for_neighbours(const Voxel& v, int radius, Visit visit) {
  for (int dx = -radius; dx <= radius; ++dx)
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dz = -radius; dz <= radius; ++dz) visit(Voxel{v.x + dx, v.y + dy, v.z + dz});
}

/// Counts the neighbours u of v, itself included, for which is(u).
template <typename Is>
int count_neighbours(const Voxel& v, int radius, Is is) {
  int count = 0;
  for_neighbours(v, radius, [&](const Voxel& u) { count += is(u); });
  return count;
}

/// Returns the value of v; nullptr when there is none.
template <typename Value>
const Value* find(const MapOf<Value>& map, const Voxel& v) {
  const auto found = map.find(v);
  return found == map.end() ? nullptr : &found->second;
}

/// Returns whether v has a value with this flag set.
template <typename Value>
bool has(const MapOf<Value>& map, const Voxel& v, bool Value::*flag) {
  const Value* value = find(map, v);
  return value != nullptr && value->*flag;
}

/// Returns the voxels from s to v on Bresenham's line, both ends included.
inline std::vector<Voxel> line(const Voxel& s, const Voxel& v) {
  const std::array<int, 3> end = {v.x, v.y, v.z};
  std::array<int, 3> q = {s.x, s.y, s.z}, d{}, g{}, e{};
  for (std::size_t a = 0; a < 3; ++a) d[a] = std::abs(end[a] - q[a]), g[a] = q[a] < end[a] ? 1 : -1;
  const int longest = *std::max_element(d.begin(), d.end());
  e.fill(longest / 2);
  std::vector<Voxel> visited;
  for (int step = 0; step <= longest; ++step) {
    visited.push_back({q[0], q[1], q[2]});
    for (std::size_t a = 0; a < 3; ++a) {
      e[a] -= d[a];
      if (e[a] < 0) e[a] += longest, q[a] += g[a];
    }
  }
  return visited;
}

/// What a scan shows.
struct SeenVoxels {
  std::vector<std::optional<Voxel>> of_point;  // none for points that do not take part
  SetOf measured, occupied, observed;  // P'_M, those within the range limit, P'_obs on the lines
  std::size_t nonfinite_points = 0;
};

struct Ranges {
  double min_m, max_m;
};

/// P_M = T_{M->S} P_S; P'_M = floor(P_M / Delta). Each ray starts at its own origin.
inline SeenVoxels see(std::span<const Point> points, const Pose& t, const RayOrigins& origins,
                      const Ranges& ranges, double size_m) {
  SeenVoxels seen;
  const auto in_range = [&](double x, double y, double z) {
    return norm_sq(x, y, z) <= squared(ranges.max_m);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point& point = points[i];
    std::optional<Voxel>& v = seen.of_point.emplace_back();
    const bool finite = std::isfinite(double{point.x} + point.y + point.z);
    seen.nonfinite_points += !finite;
    Eigen::Vector3d p;
    for (int row = 0; row < 3; ++row)
      p[row] = ((t(row, 0) * point.x + t(row, 1) * point.y) + t(row, 2) * point.z) + t(row, 3);
    const Eigen::Vector3d sensor_m = t * origins.at(i), ray = p - sensor_m;
    if (!finite || !(norm_sq(ray.x(), ray.y(), ray.z()) > squared(ranges.min_m))) continue;
    v = voxel_at(p, size_m);
    seen.measured.insert(*v);
    if (in_range(v->x * size_m - sensor_m.x(), v->y * size_m - sensor_m.y(),
                 v->z * size_m - sensor_m.z()))
      seen.occupied.insert(*v);
    const Voxel s = voxel_at(sensor_m, size_m);
    for (const Voxel& q : line(s, *v))
      if (in_range((s.x - q.x) * size_m, (s.y - q.y) * size_m, (s.z - q.z) * size_m))
        seen.observed.insert(q);
  }
  return seen;
}

/// Returns the median of a non-empty list, of an even count the mean of the middle two, truncated.
inline int median(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

/// Returns Otsu's threshold over 100 bins: the level that maximises the variance between the two
/// classes, of equal levels the highest; nullopt when no level separates the values.
inline std::optional<double> otsu(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double lo = *low, hi = *high, width = (hi - lo) / 100;
  std::array<double, 100> count{};
  for (const double s : values) {
    const double bin = s - lo < 1e-3 ? 0 : hi - s < 1e-3 ? 99 : std::ceil((s - lo) / width) - 1;
    count[static_cast<std::size_t>(bin)] += 1;
  }
  double moment = 0, weight = 0, sum = 0, best = 0;
  for (int i = 0; i < 100; ++i) moment += i * count[static_cast<std::size_t>(i)];
  const double total = static_cast<double>(values.size());
  std::optional<double> threshold;
  for (int i = 0; i < 100; ++i) {
    if (weight > 0 && total - weight > 0) {
      const double between =
          weight * (total - weight) * squared(sum / weight - (moment - sum) / (total - weight));
      if (between >= best) best = between, threshold = lo + i * (hi - lo) / 100;
    }
    weight += count[static_cast<std::size_t>(i)];
    sum += i * count[static_cast<std::size_t>(i)];
  }
  return threshold;
}

}  // namespace mosbench::hmm_mos::reference
