#include "eval/breakdown/error_scenes.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/base/median.hpp"
#include "datasets/formats/point_range.hpp"
#include "eval/breakdown/object_tracks.hpp"

namespace mosbench {
namespace {

constexpr double kNearMoving_m = 0.5;
constexpr double kSeenBefore_s = 1.0;
/// Surfaces farther off than this are other surfaces.
constexpr double kSameSurface_m = 0.5;
/// Twice what the noise of a LiDAR leaves between the same surface in two scans.
constexpr double kPosesOff_m = 0.04;
constexpr double kGround_m = 0.3;
constexpr double kThingCell_m = 0.4;
constexpr double kRangeJump_m = 0.5;
/// Smallest by largest variance of the points around: above it they scatter, and where the middle
/// one is below it they lie in one row.
constexpr double kScattered = 0.1, kInRow = 0.02;
constexpr std::size_t kFewestAround = 8;

/// Whether a point is a return that no grid is too small for.
bool has_place(const Point& point) { return is_return(point) && range_m(point) < 1e5; }

/// Points of a scan in the map, found by their place.
class PlacedPoints {
 public:
  explicit PlacedPoints(double cell_m) : cell_m_(cell_m) {}

  void add(const Eigen::Vector3d& at_m) { cells_[key_of(at_m, 0, 0, 0)].push_back(at_m); }

  /// Returns those within `radius_m`, at most a cell.
  std::vector<Eigen::Vector3d> around(const Eigen::Vector3d& at_m, double radius_m) const {
    std::vector<Eigen::Vector3d> found;
    for (int i = 0; i < 27; ++i) {
      const auto cell = cells_.find(key_of(at_m, i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
      if (cell == cells_.end()) continue;
      for (const Eigen::Vector3d& other_m : cell->second) {
        if ((other_m - at_m).squaredNorm() <= radius_m * radius_m) found.push_back(other_m);
      }
    }
    return found;
  }

 private:
  /// Places 2^20 cells apart share a key: they are none of one scan.
  std::uint64_t key_of(const Eigen::Vector3d& at_m, int dx, int dy, int dz) const {
    constexpr std::int64_t kCells = std::int64_t{1} << 20;
    const auto part = [&](double along_m, int step) {
      const auto cell = static_cast<std::int64_t>(std::floor(along_m / cell_m_)) + step;
      return static_cast<std::uint64_t>((cell + kCells) & (2 * kCells - 1));
    };
    return part(at_m.x(), dx) << 42U | part(at_m.y(), dy) << 21U | part(at_m.z(), dz);
  }

  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<Eigen::Vector3d>> cells_;
};

/// Mean of points, and their variances, rising, along `axes`.
struct Spread {
  Eigen::Vector3d mean_m, variances_m2;
  Eigen::Matrix3d axes;
};

std::optional<Spread> spread_of(std::span<const Eigen::Vector3d> points_m) {
  if (points_m.size() < kFewestAround) return std::nullopt;
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& at_m : points_m) mean_m += at_m;
  mean_m /= static_cast<double>(points_m.size());
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& at_m : points_m) {
    sum += (at_m - mean_m) * (at_m - mean_m).transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(sum / static_cast<double>(points_m.size()));
  return Spread{mean_m, solver.eigenvalues(), solver.eigenvectors()};
}

/// Nearest and farthest range of a scan by direction, a degree wide.
class RangeImage {
 public:
  explicit RangeImage(const Frame& scan) : map_from_sensor_(scan.map_from_sensor) {
    for (const Point& point : scan.points) {
      if (!has_place(point)) continue;
      const double range_m = mosbench::range_m(point);
      Pixel& seen = pixels_[pixel_of(position_of(point), 0, 0)];
      seen = {std::min(seen.nearest_m, range_m), std::max(seen.farthest_m, range_m)};
    }
  }

  /// Whether a ray went to a place of the map or beyond.
  bool saw(const Eigen::Vector3d& map_m) const {
    const Eigen::Vector3d at_m = map_from_sensor_.inverse() * map_m;
    const double range_m = at_m.norm();
    return any_beside(at_m, 1, [range_m](const Pixel& seen) {
      return seen.farthest_m >= range_m - kSameSurface_m;
    });
  }

  /// Whether a ray beside that to `at_m`, in the sensor's frame, ended a jump before or beyond.
  bool jumps_at(const Eigen::Vector3d& at_m) const {
    const double range_m = at_m.norm();
    return any_beside(at_m, 0, [range_m](const Pixel& seen) {
      return seen.nearest_m <= range_m - kRangeJump_m || seen.farthest_m >= range_m + kRangeJump_m;
    });
  }

 private:
  static constexpr int kColumns = 360, kRows = 180;
  struct Pixel {
    double nearest_m = std::numeric_limits<double>::infinity(), farthest_m = 0.0;
  };

  template <typename Holds>
  bool any_beside(const Eigen::Vector3d& at_m, int rows, Holds&& holds) const {
    for (int row = -rows; row <= rows; ++row) {
      for (int column = -1; column <= 1; ++column) {
        if (holds(pixels_[pixel_of(at_m, column, row)])) return true;
      }
    }
    return false;
  }

  static std::size_t pixel_of(const Eigen::Vector3d& at_m, int column, int row) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    const double turn = std::atan2(at_m.y(), at_m.x()) * kDegrees;
    const double rise = std::atan2(at_m.z(), std::hypot(at_m.x(), at_m.y())) * kDegrees;
    const int x = (static_cast<int>(std::floor(turn)) + column + 3 * kColumns) % kColumns;
    const int y = std::clamp(static_cast<int>(std::floor(rise)) + row + kRows / 2, 0, kRows - 1);
    return static_cast<std::size_t>(y * kColumns + x);
  }

  Pose map_from_sensor_;
  std::vector<Pixel> pixels_ = std::vector<Pixel>(std::size_t{kColumns * kRows});
};

/// Returns how far the poses put surfaces of two scans apart: the larger of the medians over level
/// and over upright surfaces. Too few places count as none.
double apart_m(std::span<const Eigen::Vector3d> scan_m, const Frame& earlier) {
  constexpr std::size_t kPlaces = 3000, kFewestPlaces = 30;
  PlacedPoints before(kSameSurface_m);
  for (const Point& point : earlier.points) {
    if (has_place(point)) before.add(earlier.map_from_sensor * position_of(point));
  }
  std::array<std::vector<double>, 2> apart_m;
  const std::size_t step = scan_m.size() / kPlaces + 1;
  for (std::size_t i = 0; i < scan_m.size(); i += step) {
    const auto surface = spread_of(before.around(scan_m[i], kSameSurface_m));
    if (!surface || surface->variances_m2[0] > 0.02 * surface->variances_m2[1]) continue;
    const Eigen::Vector3d normal = surface->axes.col(0);
    const bool is_level = std::abs(normal.z()) > 0.7;
    apart_m.at(is_level ? 0 : 1).push_back(std::abs((scan_m[i] - surface->mean_m).dot(normal)));
  }
  double worst_m = 0.0;
  for (const std::vector<double>& of_kind : apart_m) {
    if (of_kind.size() >= kFewestPlaces) worst_m = std::max(worst_m, upper_median(of_kind));
  }
  return worst_m;
}

/// The lowest points of a scan in columns of 2 m.
class LowestPoints {
 public:
  void add(const Eigen::Vector3d& at_m) {
    double& lowest_m = lowest_m_.try_emplace(column_of(at_m, 0, 0), at_m.z()).first->second;
    lowest_m = std::min(lowest_m, at_m.z());
  }

  /// Returns how high a point is above those in its column and around it.
  double height_m(const Eigen::Vector3d& at_m) const {
    double lowest_m = at_m.z();
    for (int i = 0; i < 9; ++i) {
      const auto column = lowest_m_.find(column_of(at_m, i % 3 - 1, i / 3 - 1));
      if (column != lowest_m_.end()) lowest_m = std::min(lowest_m, column->second);
    }
    return at_m.z() - lowest_m;
  }

 private:
  static std::pair<std::int64_t, std::int64_t> column_of(const Eigen::Vector3d& at_m, int dx,
                                                         int dy) {
    constexpr double kColumn_m = 2.0;
    return {static_cast<std::int64_t>(std::floor(at_m.x() / kColumn_m)) + dx,
            static_cast<std::int64_t>(std::floor(at_m.y() / kColumn_m)) + dy};
  }

  std::map<std::pair<std::int64_t, std::int64_t>, double> lowest_m_;
};

/// A static thing of a vehicle's size, or of the part of one that is seen.
bool is_of_vehicle_size(const std::vector<Eigen::Vector3d>& thing_m) {
  if (thing_m.size() < 2 * kFewestAround) return false;
  const Eigen::Vector3d size_m = smallest_box(thing_m).size_m;
  const double length_m = std::max(size_m.x(), size_m.y());
  const double width_m = std::min(size_m.x(), size_m.y());
  return length_m > 1.2 && length_m < 7.0 && width_m > 0.2 && width_m < 2.8 && size_m.z() > 0.5 &&
         size_m.z() < 3.0;
}

bool is_moving(PointOutcome outcome) {
  return outcome == PointOutcome::kTruePositive || outcome == PointOutcome::kFalseNegative;
}

/// Returns what SemanticKITTI's classes say; poles, trunks and signs are thin.
ErrorScene scene_of_class(std::uint32_t label) {
  switch (label & 0xFFFFU) {
    case 40:
    case 44:
    case 48:
    case 49:
    case 60:
    case 72:
      return ErrorScene::kGround;
    case 10:
    case 13:
    case 15:
    case 18:
    case 20:
      return ErrorScene::kParked;
    case 70:
      return ErrorScene::kVegetation;
    case 71:
    case 80:
    case 81:
      return ErrorScene::kEdge;
    default:
      return ErrorScene::kNone;
  }
}

/// A scan and what its false and missed points are told by.
class Surroundings {
 public:
  Surroundings(const JudgedScan& scan, const Frame* earlier) : scan_(scan), image_(scan.frame) {
    for (const Point& point : scan.frame.points) {
      at_m_.push_back(scan.frame.map_from_sensor * position_of(point));
    }
    std::vector<Eigen::Vector3d> returns_m;
    for (std::size_t i = 0; i < at_m_.size(); ++i) {
      if (!has_place(scan.frame.points[i])) continue;
      returns_m.push_back(at_m_[i]);
      around_.add(at_m_[i]);
      lowest_.add(at_m_[i]);
      (is_moving(scan.outcomes[i]) ? moving_ : standing_).add(at_m_[i]);
    }
    if (earlier != nullptr) {
      before_.emplace(*earlier);
      poses_off_ = apart_m(returns_m, *earlier) > kPosesOff_m;
    }
    find_vehicles();
  }

  ErrorScene of(std::size_t point, ErrorScene by_class) const {
    if (!has_place(scan_.frame.points[point])) return ErrorScene::kElse;
    const Eigen::Vector3d& at_m = at_m_[point];
    const bool is_missed = scan_.outcomes[point] == PointOutcome::kFalseNegative;
    if (!is_missed && !moving_.around(at_m, kNearMoving_m).empty()) return ErrorScene::kNearMoving;
    if (!before_ || !before_->saw(at_m)) return ErrorScene::kFirstSight;
    if (poses_off_) return ErrorScene::kPose;
    if (by_class != ErrorScene::kNone) return by_class;
    if (lowest_.height_m(at_m) <= kGround_m) return ErrorScene::kGround;
    if (is_on_vehicle_[point]) return ErrorScene::kParked;
    const auto standing = spread_of(standing_.around(at_m, kSameSurface_m));
    if (standing && standing->variances_m2[0] > kScattered * standing->variances_m2[2]) {
      return ErrorScene::kVegetation;
    }
    const auto around = spread_of(around_.around(at_m, kSameSurface_m));
    const bool is_thin = !around || around->variances_m2[1] < kInRow * around->variances_m2[2];
    const bool is_edge = is_thin || image_.jumps_at(position_of(scan_.frame.points[point]));
    return is_edge ? ErrorScene::kEdge : ErrorScene::kElse;
  }

 private:
  /// Marks the points of static things of a vehicle's size above the ground.
  void find_vehicles() {
    is_on_vehicle_.resize(at_m_.size());
    std::vector<std::size_t> above;
    std::vector<Eigen::Vector3d> above_m;
    for (std::size_t i = 0; i < at_m_.size(); ++i) {
      if (!has_place(scan_.frame.points[i]) || is_moving(scan_.outcomes[i])) continue;
      if (lowest_.height_m(at_m_[i]) <= kGround_m) continue;
      above.push_back(i);
      above_m.push_back(at_m_[i]);
    }
    for (const Cluster& members : cluster_points(above_m, kThingCell_m)) {
      std::vector<Eigen::Vector3d> thing_m;
      for (const std::uint32_t member : members) thing_m.push_back(above_m[member]);
      if (!is_of_vehicle_size(thing_m)) continue;
      for (const std::uint32_t member : members) is_on_vehicle_[above[member]] = true;
    }
  }

  const JudgedScan& scan_;
  RangeImage image_;
  std::optional<RangeImage> before_;
  bool poses_off_ = false;
  std::vector<Eigen::Vector3d> at_m_;
  PlacedPoints around_{kSameSurface_m}, standing_{kSameSurface_m}, moving_{kNearMoving_m};
  LowestPoints lowest_;
  std::vector<bool> is_on_vehicle_;
};

bool is_error(PointOutcome outcome) {
  return outcome == PointOutcome::kFalsePositive || outcome == PointOutcome::kFalseNegative;
}

}  // namespace

std::vector<ErrorScene> error_scenes(const JudgedScan& scan, const Frame* earlier,
                                     std::span<const std::uint32_t> classes) {
  std::vector<ErrorScene> scenes(scan.outcomes.size(), ErrorScene::kNone);
  if (std::ranges::none_of(scan.outcomes, is_error)) return scenes;
  const Surroundings surroundings(scan, earlier);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!is_error(scan.outcomes[i])) continue;
    scenes[i] =
        surroundings.of(i, classes.empty() ? ErrorScene::kNone : scene_of_class(classes[i]));
  }
  return scenes;
}

std::vector<double> times_of_all(const Sequence& sequence) {
  std::vector<std::size_t> all(sequence.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return scan_times(sequence, all).times_s;
}

std::vector<ErrorScene> error_scenes(const ResultScans& scans, std::size_t scan_index,
                                     const JudgedScan& scan, std::span<const double> times_s) {
  std::optional<Frame> earlier;
  for (std::size_t k = scan_index; k-- > 0 && !earlier;) {
    if (times_s[k] <= times_s[scan_index] - kSeenBefore_s) earlier = scans.sequence().read(k);
  }
  const bool has_classes = scan.frame.truth && scans.dataset().kind == DatasetKind::kSemanticKitti;
  return error_scenes(scan, earlier ? &*earlier : nullptr,
                      has_classes ? *scan.frame.truth : std::span<const std::uint32_t>());
}

}  // namespace mosbench
