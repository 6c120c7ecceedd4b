#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mosbench/scan.hpp>
#include <vector>

#include "datasets/doctor/surface_cells.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Two scans, `later` being some scans behind `earlier`.
struct ScanPair {
  std::size_t earlier = 0, later = 0;
};

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair);

/// How far the two motions put a point at 10 m from one another, about.
double difference_m(const Pose& a, const Pose& b);

/// Of at least one value; the upper one of the two in the middle.
double median(std::vector<double> values);

/// Scans of a sequence read once and kept in the forms that laying them over one another needs.
class ScanOverlap {
 public:
  explicit ScanOverlap(const Sequence& sequence) : sequence_(sequence) {}

  /// Whether both scans have points enough to tell. This and the others throw DataError.
  bool can_tell(const ScanPair& pair) { return at(pair.later).moved_m.size() >= kFewestPoints; }
  /// Of the later scan with the surfaces of the earlier one, see SurfaceCells.
  double overlap(const ScanPair& pair, const Pose& motion) {
    return at(pair.earlier).cells.overlap(at(pair.later).moved_m, motion);
  }
  /// The same of what stands upright. The rings of a sparse sensor on the ground stay where they
  /// are when the sensor moves, and speak for standing still.
  double upright_overlap(const ScanPair& pair, const Pose& motion) {
    return at(pair.earlier).upright.overlap(at(pair.later).upright_m, motion);
  }
  Alignment align_upright(const ScanPair& pair, const Pose& start) {
    return align(at(pair.earlier).upright, at(pair.later).upright_m, start);
  }
  std::size_t scans_read() const { return scans_.size(); }

 private:
  static constexpr std::size_t kFewestPoints = 200;
  struct Scan {
    std::vector<Eigen::Vector3d> moved_m, upright_m;
    SurfaceCells cells, upright;
  };
  const Scan& at(std::size_t scan_index);

  const Sequence& sequence_;
  std::map<std::size_t, std::unique_ptr<Scan>> scans_;
};

}  // namespace mosbench
