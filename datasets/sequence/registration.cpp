#include "datasets/sequence/registration.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/text/numbers.hpp"

namespace mosbench {
namespace {

using Columns = std::unordered_map<std::uint64_t, std::pair<double, double>>;

constexpr double kOverlapCellM = 1.0;

constexpr double kColumnM = 1.0;
constexpr std::size_t kFewestOfSurface = 5;
constexpr double kThinM = 0.05;
constexpr double kCoarseM = 0.4;
/// A surface is spread along a direction when its deviation is larger, metres.
constexpr double kSpreadM = 0.12;
constexpr double kNone = 1e12;

/// Points of a cube, summed up.
struct CellMoments {
  std::size_t count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();

  Eigen::Vector3d mean_m() const { return sum / static_cast<double>(count); }
  Eigen::Matrix3d covariance_m2() const {
    const Eigen::Vector3d mean = mean_m();
    return squares / static_cast<double>(count) - mean * mean.transpose();
  }
};

std::unordered_map<std::uint64_t, CellMoments> moments_of_cells(
    std::span<const Eigen::Vector3d> points_m, double size_m) {
  std::unordered_map<std::uint64_t, CellMoments> cells;
  for (const Eigen::Vector3d& point_m : points_m) {
    CellMoments& cell = cells[cube_key(point_m, size_m)];
    ++cell.count;
    cell.sum += point_m;
    cell.squares += point_m * point_m.transpose();
  }
  return cells;
}

/// Returns the points at 2 to 40 m, where scans are dense.
std::vector<Eigen::Vector3d> near_points(std::span<const Point> points) {
  constexpr double kNearestM = 2.0, kFurthestM = 40.0;
  std::vector<Eigen::Vector3d> near_m;
  for (const Point& point : points) {
    const Eigen::Vector3d point_m = position_of(point);
    const double range_m = point_m.norm();
    if (range_m >= kNearestM && range_m <= kFurthestM) near_m.push_back(point_m);
  }
  return near_m;
}

std::uint64_t column_key(const Eigen::Vector3d& point_m) {
  return cube_key({point_m.x(), point_m.y(), 0.0}, kColumnM);
}

Columns columns_of(std::span<const Eigen::Vector3d> points_m) {
  Columns columns;
  for (const Eigen::Vector3d& point_m : points_m) {
    auto& [low_m, high_m] =
        columns.try_emplace(column_key(point_m), point_m.z(), point_m.z()).first->second;
    low_m = std::min(low_m, point_m.z());
    high_m = std::max(high_m, point_m.z());
  }
  return columns;
}

bool is_flat(const Columns& columns, const Eigen::Vector3d& point_m) {
  constexpr double kFlatM = 0.5;
  const auto column = columns.find(column_key(point_m));
  return column != columns.end() && column->second.second - column->second.first < kFlatM;
}

RegisteredScan::Surface surface_of(const CellMoments& cell, bool flat) {
  RegisteredScan::Surface surface;
  surface.mean_m = cell.mean_m();
  const Eigen::Matrix3d covariance = cell.covariance_m2();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  surface.directions = eigen.eigenvectors();
  const Eigen::Vector3d variance_m2 = eigen.eigenvalues().cwiseMax(0.0);
  const double spread_m2 = kSpreadM * kSpreadM;
  surface.variance_m2 = variance_m2;
  if (variance_m2[0] > spread_m2) return surface;  // a bush
  if (variance_m2[1] > spread_m2) {                // a plane
    surface.variance_m2 = {variance_m2[0], kNone, kNone};
    return surface;
  }
  const Eigen::Vector3d line = surface.directions.col(2);
  if (std::abs(line.z()) > 0.8) {  // a pole
    surface.variance_m2 = {variance_m2[0], variance_m2[1], kNone};
    return surface;
  }
  // One ring: on the ground it holds in height, on a wall across.
  const Eigen::Vector3d across = line.cross(Eigen::Vector3d::UnitZ()).normalized();
  surface.directions.col(0) = flat ? Eigen::Vector3d::UnitZ() : across;
  surface.directions.col(1) = flat ? across : Eigen::Vector3d::UnitZ();
  const double held = surface.directions.col(0).dot(covariance * surface.directions.col(0));
  surface.variance_m2 = {std::max(held, 0.0), kNone, kNone};
  return surface;
}

Eigen::Matrix3d crossing(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return cross;
}

Pose stepped(const Vector6& step, const Pose& pose) {
  Pose moved = pose;
  const Eigen::Vector3d rotation = step.tail<3>();
  const double angle = rotation.norm();
  if (angle > 1e-12) {
    moved.prerotate(Eigen::AngleAxisd(angle, rotation / angle));
  }
  moved.pretranslate(Eigen::Vector3d(step.head<3>()));
  return moved;
}

struct Normal {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

/// Sums up what pulls the later scan onto the surfaces of the earlier one.
Normal normal_at(const RegisteredScan& earlier, const RegisteredScan& later, const Pose& motion,
                 double thickness_m) {
  Normal sums;
  const auto add = [&](const Eigen::Vector3d& point_m) {
    const Eigen::Vector3d moved_m = motion * point_m;
    const auto* surface = earlier.surface_at(moved_m);
    if (surface == nullptr) return;
    const Eigen::Vector3d offset_m = moved_m - surface->mean_m;
    const Eigen::Matrix3d information = surface->information(thickness_m);
    const Eigen::Vector3d pull = information * offset_m;
    const double weight = std::exp(-0.5 * offset_m.dot(pull));
    if (weight < 1e-3) return;
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << Eigen::Matrix3d::Identity(), -crossing(moved_m);
    sums.information.noalias() += weight * jacobian.transpose() * information * jacobian;
    sums.gradient.noalias() += weight * jacobian.transpose() * pull;
  };
  std::ranges::for_each(later.upright_m, add);
  std::ranges::for_each(later.ground_m, add);
  // Directions that nothing holds stay where they are.
  sums.information.diagonal().array() += 1e-3;
  return sums;
}

std::vector<Eigen::Vector3d> thinned(const std::vector<Eigen::Vector3d>& points_m, double size_m,
                                     std::size_t most) {
  std::unordered_set<std::uint64_t> taken;
  std::vector<Eigen::Vector3d> kept_m;
  for (const Eigen::Vector3d& point_m : points_m) {
    if (taken.insert(cube_key(point_m, size_m)).second) kept_m.push_back(point_m);
  }
  return picked(kept_m, most);
}

/// Gives each upright point its share of what holds the scan sideways.
void weigh(RegisteredScan& scan) {
  std::vector<Eigen::Matrix2d> holds;
  Eigen::Matrix2d all = Eigen::Matrix2d::Identity() * 1e-6;
  for (const Eigen::Vector3d& point_m : scan.upright_m) {
    const auto* surface = scan.surface_at(point_m);
    holds.emplace_back(Eigen::Matrix2d::Zero());
    if (surface == nullptr) continue;
    holds.back() = kThinM * kThinM * surface->information(kThinM).topLeftCorner<2, 2>();
    all += holds.back();
  }
  const Eigen::Matrix2d shares = all.inverse();
  for (const Eigen::Matrix2d& hold : holds) scan.leverage.push_back(0.5 * (shares * hold).trace());
}

}  // namespace

Pose relative(const std::vector<Pose>& poses, const ScanPair& pair) {
  return poses[pair.earlier].inverse() * poses[pair.later];
}

double difference_m(const Pose& a, const Pose& b) {
  constexpr double kRangeM = 10.0;
  const Pose between = a.inverse() * b;
  return between.translation().norm() + kRangeM * Eigen::AngleAxisd(between.linear()).angle();
}

double median(std::vector<double> values) {
  return values.empty() ? 0.0 : quantile(std::move(values), 0.5, QuantileRule::kUpper);
}

std::uint64_t cube_key(const Eigen::Vector3d& point_m, double size_m) {
  constexpr double kFarthestCell = 1 << 20;
  constexpr std::uint64_t kNowhere = std::uint64_t{1} << 63U;  // no cell that fits 3 x 21 bits
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(point_m[axis] / size_m);
    if (!(std::abs(cell) < kFarthestCell)) return kNowhere;
    key = (key << 21U) | (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & 0x1FFFFFU);
  }
  return key;
}

const ScanOverlap::Scan& ScanOverlap::at(std::size_t scan_index) {
  constexpr std::size_t kSurfacePoints = 40000, kMovedPoints = 1500, kFewestOfSurface = 5;
  constexpr double kThinnestM = 0.08;  // noise and unevenness of a surface
  if (const auto known = scans_.find(scan_index); known != scans_.end()) return known->second;
  const std::vector<Eigen::Vector3d> near_m = near_points(sequence_.read(scan_index).points);
  Scan& scan = scans_[scan_index];
  scan.moved_m = picked(near_m, kMovedPoints);
  for (const auto& [key, moments] :
       moments_of_cells(picked(near_m, kSurfacePoints), kOverlapCellM)) {
    if (moments.count < kFewestOfSurface) continue;
    const Eigen::Matrix3d covariance_m2 =
        moments.covariance_m2() + kThinnestM * kThinnestM * Eigen::Matrix3d::Identity();
    scan.surfaces.emplace(key, Surface{moments.mean_m(), covariance_m2.inverse()});
  }
  return scan;
}

bool ScanOverlap::has_points(const ScanPair& pair) {
  constexpr std::size_t kFewestPoints = 200;
  return at(pair.later).moved_m.size() >= kFewestPoints;
}

double ScanOverlap::overlap(const ScanPair& pair, const Pose& motion) {
  const auto& surfaces = at(pair.earlier).surfaces;
  const std::vector<Eigen::Vector3d>& points_m = at(pair.later).moved_m;
  double sum = 0.0;
  for (const Eigen::Vector3d& point_m : points_m) {
    const Eigen::Vector3d moved_m = motion * point_m;
    const auto surface = surfaces.find(cube_key(moved_m, kOverlapCellM));
    if (surface == surfaces.end()) continue;
    const Eigen::Vector3d offset_m = moved_m - surface->second.mean_m;
    sum += std::exp(-0.5 * offset_m.dot(surface->second.information * offset_m));
  }
  return points_m.empty() ? 0.0 : sum / static_cast<double>(points_m.size());
}

Eigen::Matrix3d RegisteredScan::Surface::information(double thickness_m) const {
  const Eigen::Vector3d weights =
      (variance_m2.array() + thickness_m * thickness_m).inverse().matrix();
  return directions * weights.asDiagonal() * directions.transpose();
}

bool RegisteredScan::Surface::is_plane() const { return variance_m2[1] == kNone; }

RegisteredScan::RegisteredScan(std::span<const Point> points, double size_m) : cell_m(size_m) {
  constexpr std::size_t kSurfacePoints = 40000, kUpright = 1500, kGround = 500;
  constexpr double kUprightCellM = 0.4, kGroundCellM = 1.0;
  const std::vector<Eigen::Vector3d> near_m = near_points(points);
  const std::vector<Eigen::Vector3d> surface_m = picked(near_m, kSurfacePoints);
  const Columns surface_columns = columns_of(surface_m), columns = columns_of(near_m);
  for (const auto& [key, cell] : moments_of_cells(surface_m, cell_m)) {
    if (cell.count < kFewestOfSurface) continue;
    surfaces.emplace(key, surface_of(cell, is_flat(surface_columns, cell.mean_m())));
  }
  for (const Eigen::Vector3d& point_m : near_m) {
    (is_flat(columns, point_m) ? ground_m : upright_m).push_back(point_m);
  }
  upright_m = thinned(upright_m, kUprightCellM, kUpright);
  ground_m = thinned(ground_m, kGroundCellM, kGround);
  weigh(*this);
}

const RegisteredScan::Surface* RegisteredScan::surface_at(const Eigen::Vector3d& point_m) const {
  const auto found = surfaces.find(cube_key(point_m, cell_m));
  return found == surfaces.end() ? nullptr : &found->second;
}

std::vector<Eigen::Vector3d> sparse_ground_m(std::span<const Point> points) {
  const std::vector<Eigen::Vector3d> near_m = near_points(points);
  const Columns columns = columns_of(near_m);
  std::vector<Eigen::Vector3d> ground_m;
  for (const Eigen::Vector3d& point_m : near_m) {
    if (is_flat(columns, point_m)) ground_m.push_back(point_m);
  }
  return thinned(ground_m, kColumnM, ground_m.size());
}

double upright_overlap(const RegisteredScan& earlier, const RegisteredScan& later,
                       const Pose& motion, std::size_t step, double thickness_m) {
  double sum = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < later.upright_m.size(); i += step) {
    whole += later.leverage[i];
    const Eigen::Vector3d moved_m = motion * later.upright_m[i];
    const auto* surface = earlier.surface_at(moved_m);
    if (surface == nullptr) continue;
    const Eigen::Vector3d offset_m = moved_m - surface->mean_m;
    sum += later.leverage[i] *
           std::exp(-0.5 * offset_m.dot(surface->information(thickness_m) * offset_m));
  }
  return whole > 0.0 ? sum / whole : 0.0;
}

Registration registered(const RegisteredScan& earlier, const RegisteredScan& later,
                        const Pose& start) {
  constexpr int kMostSteps = 12;
  constexpr double kStillM = 1e-3;
  // The deviation is larger than the curvature says, since neighbouring points err alike.
  constexpr double kCovarianceFactor = 9.0;
  Registration result;
  result.motion = start;
  for (const double thickness_m : {kCoarseM, 2.0 * kThinM, kThinM}) {
    for (int step = 0; step < kMostSteps; ++step) {
      const Normal normal = normal_at(earlier, later, result.motion, thickness_m);
      const Vector6 change = -normal.information.ldlt().solve(normal.gradient);
      if (!change.allFinite() || change.norm() > 5.0) break;
      result.motion = stepped(change, result.motion);
      if (change.norm() < kStillM) break;
    }
  }
  result.covariance =
      kCovarianceFactor * normal_at(earlier, later, result.motion, kThinM).information.inverse();
  result.overlap = upright_overlap(earlier, later, result.motion, 1, kThinM);
  return result;
}

Pose searched_start(const RegisteredScan& earlier, const RegisteredScan& later,
                    const Pose& around) {
  constexpr double kStepM = 0.5, kReachM = 4.0;
  constexpr std::size_t kEvery = 4;
  Pose best = around;
  double best_overlap = 0.0;
  const int reach = static_cast<int>(kReachM / kStepM);
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      Pose start = around;
      start.pretranslate(Eigen::Vector3d(kStepM * x, kStepM * y, 0.0));
      const double overlap = upright_overlap(earlier, later, start, kEvery, kCoarseM);
      if (overlap <= best_overlap) continue;
      best_overlap = overlap;
      best = start;
    }
  }
  return best;
}

}  // namespace mosbench
