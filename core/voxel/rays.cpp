#include "core/voxel/rays.hpp"

#include <algorithm>
#include <cmath>

namespace mosbench {
namespace {

double distance_sq_m2(std::int32_t dx, std::int32_t dy, std::int32_t dz, double voxel_size_m) {
  const double x = dx * voxel_size_m, y = dy * voxel_size_m, z = dz * voxel_size_m;
  return (x * x + y * y) + z * z;
}

/// Number of voxels within range on the line to a voxel beyond it. The distance never falls
/// along a line, so a guess from the ratio of lengths is corrected step by step.
std::int32_t visits_within_range(const Ray& ray, double range_sq_m2, double voxel_size_m) {
  const std::int32_t longest = longest_side(ray);
  const Line line(longest);
  const auto inside = [&](std::int32_t step) {
    return distance_sq_m2(line.moves(ray.dx, step), line.moves(ray.dy, step),
                          line.moves(ray.dz, step), voxel_size_m) <= range_sq_m2;
  };
  const double full_sq_m2 = distance_sq_m2(ray.dx, ray.dy, ray.dz, voxel_size_m);
  auto step = static_cast<std::int32_t>(longest * std::sqrt(range_sq_m2 / full_sq_m2));
  step = std::min(step, longest);
  while (step > 0 && !inside(step)) --step;
  while (step < longest && inside(step + 1)) ++step;
  return step + 1;
}

std::array<std::int32_t, 3> corner_from_sensor(const RaySource& source, std::size_t slot) {
  const Voxel first = voxel_at(source.measured.blocks[slot], 0);
  return {first.x - source.sensor.x, first.y - source.sensor.y, first.z - source.sensor.z};
}

/// Farthest coordinate of a block from the sensor along one axis.
std::int32_t farthest(std::int32_t corner) {
  return std::max(std::abs(corner), std::abs(corner + kBlockSide - 1));
}

void append_ray(const Ray& ray, std::int64_t short_limit, Rays& rays) {
  const std::int32_t longest = longest_side(ray);
  if (longest <= INT16_MAX && std::int64_t{ray.visits} * longest < short_limit) {
    rays.unordered.push_back({static_cast<std::int16_t>(ray.dx), static_cast<std::int16_t>(ray.dy),
                              static_cast<std::int16_t>(ray.dz),
                              static_cast<std::int16_t>(ray.visits)});
  } else {
    rays.long_rays.push_back(ray);
  }
}

void append_rays(const RaySource& source, std::size_t slot, std::int64_t short_limit, Rays& rays) {
  const double range_sq_m2 = source.max_range_m * source.max_range_m;
  const auto corner = corner_from_sensor(source, slot);
  const bool all_inside = distance_sq_m2(farthest(corner[0]), farthest(corner[1]),
                                         farthest(corner[2]), source.voxel_size_m) <= range_sq_m2;
  for_each_cell(source.measured.masks[slot], [&](std::uint32_t cell) {
    Ray ray{corner[0] + static_cast<std::int32_t>(cell & 7),
            corner[1] + static_cast<std::int32_t>((cell >> 3) & 7),
            corner[2] + static_cast<std::int32_t>(cell >> 6), 0};
    const bool inside =
        all_inside || distance_sq_m2(ray.dx, ray.dy, ray.dz, source.voxel_size_m) <= range_sq_m2;
    ray.visits =
        inside ? longest_side(ray) + 1 : visits_within_range(ray, range_sq_m2, source.voxel_size_m);
    append_ray(ray, short_limit, rays);
  });
}

/// Places of the rays with one number of visits, as a table of eight columns that is filled column
/// by column. The eight of a row are cast together and come from distant parts of the scan.
struct Bucket {
  std::uint32_t begin = 0, rows = 0, row = 0, column = 0, rest = 0;

  std::uint32_t next() {
    if (column == 8 || rows == 0) return begin + rows * 8 + rest++;
    const std::uint32_t place = begin + row * 8 + column;
    if (++row == rows) {
      row = 0;
      ++column;
    }
    return place;
  }
};

void order(const std::vector<ShortRay>& unordered, std::vector<ShortRay>& ordered) {
  std::vector<std::uint32_t> counts;
  for (const ShortRay& ray : unordered) {
    const auto visits = static_cast<std::size_t>(ray.visits);
    if (counts.size() <= visits) counts.resize(visits + 1);
    ++counts[visits];
  }
  std::vector<Bucket> buckets;
  std::uint32_t begin = 0;
  for (const std::uint32_t count : counts) {
    buckets.push_back({.begin = begin, .rows = count / 8});
    begin += count;
  }
  ordered.resize(unordered.size());
  for (const ShortRay& ray : unordered) {
    ordered[buckets[static_cast<std::size_t>(ray.visits)].next()] = ray;
  }
}

}  // namespace

std::int32_t longest_side(const Ray& ray) {
  return std::max({std::abs(ray.dx), std::abs(ray.dy), std::abs(ray.dz)});
}

Line::Line(std::int32_t longest)
    : reciprocal((std::int64_t{1} << kLineFraction) / longest + 1),
      start((longest - 1 - longest / 2) * reciprocal) {}

std::int32_t Line::moves(std::int32_t distance, std::int32_t step) const {
  const std::int64_t numerator = std::int64_t{step} * std::abs(distance);
  const auto moved = static_cast<std::int32_t>((numerator * reciprocal + start) >> kLineFraction);
  return distance < 0 ? -moved : moved;
}

void collect_rays(const RaySource& source, BlockShare share, std::int64_t short_limit, Rays& rays) {
  rays.unordered.clear();
  rays.long_rays.clear();
  for (std::size_t slot = share.first; slot < source.measured.block_count(); slot += share.stride) {
    append_rays(source, slot, short_limit, rays);
  }
  order(rays.unordered, rays.short_rays);
}

std::size_t Rays::memory_bytes() const {
  return (short_rays.capacity() + unordered.capacity()) * sizeof(ShortRay) +
         long_rays.capacity() * sizeof(Ray);
}

RayBounds bounds_of(const RaySource& source) {
  // Rays that end outside the range stop there.
  const auto reach =
      static_cast<std::int32_t>(std::ceil(source.max_range_m / source.voxel_size_m)) + 1;
  RayBounds bounds;
  for (std::size_t slot = 0; slot < source.measured.block_count(); ++slot) {
    const auto corner = corner_from_sensor(source, slot);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.low[axis] = std::min(bounds.low[axis], std::max(corner[axis], -reach));
      bounds.high[axis] =
          std::max(bounds.high[axis], std::min(corner[axis] + kBlockSide - 1, reach));
    }
  }
  return bounds;
}

}  // namespace mosbench
