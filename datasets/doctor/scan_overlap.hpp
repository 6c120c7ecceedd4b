#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mosbench/scan.hpp>
#include <vector>

#include "datasets/doctor/surface_cells.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Two scans of a sequence.
struct ScanPair {
  std::size_t earlier = 0, later = 0;
};

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair);

/// Returns about how far apart the two motions put a point 10 m away, metres.
double difference_m(const Pose& a, const Pose& b);

/// Median of a non-empty list; for even sizes the upper middle value.
double median(std::vector<double> values);

/// Scans of a sequence, each read once, in the forms that are needed to compare them.
class ScanOverlap {
 public:
  explicit ScanOverlap(const Sequence& sequence) : sequence_(sequence) {}

  /// Returns whether the later scan has enough points. This and the others throw DataError.
  bool has_points(const ScanPair& pair) { return at(pair.later).moved_m.size() >= kFewestPoints; }
  /// Returns the overlap of the later scan with the surfaces of the earlier one, see SurfaceCells.
  double overlap(const ScanPair& pair, const Pose& motion) {
    return at(pair.earlier).cells.overlap(at(pair.later).moved_m, motion);
  }

 private:
  static constexpr std::size_t kFewestPoints = 200;
  struct Scan {
    std::vector<Eigen::Vector3d> moved_m;
    SurfaceCells cells;
  };
  const Scan& at(std::size_t scan_index);

  const Sequence& sequence_;
  std::map<std::size_t, std::unique_ptr<Scan>> scans_;
};

}  // namespace mosbench
