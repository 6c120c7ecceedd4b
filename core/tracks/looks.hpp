#pragma once

#include <cstdint>
#include <mosbench/scan.hpp>
#include <span>
#include <vector>

#include "core/base/thread_pool.hpp"
#include "core/tracks/sight.hpp"

namespace mosbench::tracks {

/// What other scans say of a point's place.
struct Evidence {
  std::uint8_t through_before = 0, hit_before = 0;  ///< looks of earlier scans
  std::uint8_t through_after = 0, hit_after = 0;    ///< looks of later scans

  int through() const { return through_before + through_after; }
  int hit() const { return hit_before + hit_after; }
};

/// Another scan that looks at the points of a scan.
struct Look {
  const SightImage* image = nullptr;
  Eigen::Isometry3f there_from_here = Eigen::Isometry3f::Identity();
  bool before = false;  ///< it is an earlier one

  Sight at(const Eigen::Vector3f& point_m) const { return image->at(there_from_here * point_m); }
};

/// Returns what some looks say of a point in its sensor's frame.
Evidence evidence_of(const Eigen::Vector3f& point_m, std::span<const Look> looks);

/// Says whether a point goes along with the sensor, as a part of the vehicle or person that carries
/// it: it is within 3 m, and most scans from other places measured it where it is from the sensor.
bool is_carrier(const Eigen::Vector3f& point_m, std::span<const Look> looks);

}  // namespace mosbench::tracks
