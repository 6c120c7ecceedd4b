#pragma once

#include <cstddef>
#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"

namespace mosbench::tracks {

/// What a scan says of a place.
enum class Sight : std::uint8_t {
  kHidden,   ///< nothing: no ray there, or all ended before
  kThrough,  ///< all rays around it went on
  kHit       ///< a ray ended there, or one nearer and one farther: a surface may be between
};

/// A direction as a pixel, and how far away it is.
struct Bearing {
  int row = 0, column = 0;
  float range_m = 0;
};

/// The pixel of a position in the sensor's frame: half a degree high, 0.4 degrees wide.
Bearing bearing_of(const Eigen::Vector3f& position_m);

/// The ranges of one sensor's points by direction. Positions are from the sensor.
class SensorImage {
 public:
  /// Takes the points farther away than `min_range_m`; those that are not finite are left out.
  SensorImage(std::span<const Point> points, double min_range_m);

  Sight at(const Eigen::Vector3f& position_m) const;
  bool repeats(const Eigen::Vector3f& position_m) const;
  std::size_t memory_bytes() const { return pixels_.capacity() * sizeof(Span); }

 private:
  /// Of the 3 x 3 pixels around each; without a ray nearest > farthest.
  struct Span {
    float nearest_m, farthest_m;
  };
  const Span* around(const Bearing& bearing) const;

  int first_row_ = 0;
  std::vector<Span> pixels_;
};

/// The ranges of a scan by direction, from each place that its rays start at.
class SightImage {
 public:
  SightImage() = default;
  SightImage(std::span<const Point> points, double min_range_m, const RayOrigins& origins = {});

  /// Says what the scan says of a position in its frame; what one sensor hit, no other sees
  /// through.
  Sight at(const Eigen::Vector3f& position_m) const;
  /// Says whether a ray ended at this range in this direction, to 0.1 m.
  bool repeats(const Eigen::Vector3f& position_m) const;

  std::size_t memory_bytes() const;

 private:
  struct View {
    Eigen::Vector3f sensor_m;
    SensorImage image;
  };
  std::vector<View> views_;
};

}  // namespace mosbench::tracks
