#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mosbench/scan.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Two scans of a sequence.
struct ScanPair {
  std::size_t earlier = 0, later = 0;
};

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair);

/// Returns about how far apart the two motions put a point 10 m away, metres.
double difference_m(const Pose& a, const Pose& b);

/// Median of a list, for even sizes the upper middle value; 0 of an empty one.
double median(std::vector<double> values);

/// Returns a key of the cube of a grid that holds the point; one and the same key for all points
/// that are too far away for the grid.
std::uint64_t cube_key(const Eigen::Vector3d& point_m, double size_m);

/// Returns up to `most` of the items, evenly picked.
template <typename Item>
std::vector<Item> picked(const std::vector<Item>& items, std::size_t most) {
  if (items.size() <= most) return items;
  std::vector<Item> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(items[i * items.size() / most]);
  return some;
}

/// Scans of a sequence, each read once, in the forms that are needed to compare them. The surfaces
/// of a scan are one normal distribution per cell of a grid (the NDT of Biber and Strasser, 2003).
/// Unlike the distance to the nearest point it does not favour standing still because of the rings
/// of a sparse sensor on the ground.
class ScanOverlap {
 public:
  explicit ScanOverlap(const Sequence& sequence) : sequence_(sequence) {}

  /// Returns whether the later scan has enough points. This and the others throw DataError.
  bool has_points(const ScanPair& pair);
  /// Returns how well points of the later scan lie on surfaces of the earlier one: the mean over
  /// the points of a likelihood that is 1 in the middle of a surface and 0 where there is none.
  double overlap(const ScanPair& pair, const Pose& motion);

 private:
  struct Surface {
    Eigen::Vector3d mean_m;
    Eigen::Matrix3d information;
  };
  struct Scan {
    std::vector<Eigen::Vector3d> moved_m;
    std::unordered_map<std::uint64_t, Surface> surfaces;
  };
  const Scan& at(std::size_t scan_index);

  const Sequence& sequence_;
  std::map<std::size_t, Scan> scans_;
};

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A scan as others are registered to it, by its surfaces, and as it is registered to others, by
/// some points per cell, so that near surfaces do not outweigh far ones.
struct RegisteredScan {
  /// A surface with the directions in which it holds a point: a plane along its normal, a pole
  /// sideways. Rings on the ground hold a point in height only, because they move with the sensor.
  struct Surface {
    Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
    /// Per direction (columns) the variance of the surface's points along it; none where infinite.
    Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
    Eigen::Vector3d variance_m2 = Eigen::Vector3d::Zero();
    Eigen::Matrix3d information(double thickness_m) const;
    /// Returns whether it holds a point along its first direction only.
    bool is_plane() const;
  };

  RegisteredScan(std::span<const Point> points, double size_m);
  const Surface* surface_at(const Eigen::Vector3d& point_m) const;

  double cell_m;
  std::unordered_map<std::uint64_t, Surface> surfaces;
  std::vector<Eigen::Vector3d> upright_m;  ///< in columns that are not flat
  /// What each of them counts in the overlap, 1 in the sum. Points that hold the scan in a
  /// direction in which few do count more: on a straight road, posts more than the barrier.
  std::vector<double> leverage;
  std::vector<Eigen::Vector3d> ground_m;  ///< in flat columns
};

/// Returns some points of flat surfaces, about one per square metre.
std::vector<Eigen::Vector3d> sparse_ground_m(std::span<const Point> points);

/// A motion measured by two scans.
struct Registration {
  Pose motion = Pose::Identity();  ///< earlier_from_later
  double overlap = 0.0;            ///< of upright surfaces, 0 to 1
  /// Of (translation, rotation) errors of the motion, in the frame of the earlier scan.
  Matrix6 covariance = Matrix6::Zero();
};

double upright_overlap(const RegisteredScan& earlier, const RegisteredScan& later,
                       const Pose& motion, std::size_t step = 1, double thickness_m = 0.05);
/// Returns the motion near `start` that brings the later scan onto the surfaces of the earlier.
Registration registered(const RegisteredScan& earlier, const RegisteredScan& later,
                        const Pose& start);
/// Returns a start for `registered`, found among translations of `around` by up to 4 m sideways.
Pose searched_start(const RegisteredScan& earlier, const RegisteredScan& later,
                    const Pose& around = Pose::Identity());

}  // namespace mosbench
