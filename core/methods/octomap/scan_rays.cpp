#include "core/methods/octomap/scan_rays.hpp"

#include <cmath>

namespace mosbench::octomap {
namespace {

/// Length of a vector, rounded as by octomath.
double norm_of(const Eigen::Vector3f& v) {
  const float squares = (v.x() * v.x() + v.y() * v.y()) + v.z() * v.z();
  return std::sqrt(static_cast<double>(squares));
}

Voxel voxel_at(const Eigen::Vector3f& p, double voxels_per_m) {
  const auto index = [&](float c) {
    return static_cast<std::int32_t>(std::floor(voxels_per_m * static_cast<double>(c)));
  };
  return {index(p.x()), index(p.y()), index(p.z())};
}

/// A ray from the sensor to a point, or as far as the range limit.
struct Line {
  Eigen::Vector3f end;
  Voxel end_voxel;
  bool cut;
};

/// A scan in the single precision of the library.
class Lines {
 public:
  Lines(const PosedScan& scan, const VoxelGrid& grid, const Config& config)
      : config_(config), voxels_per_m_(1.0 / config.voxel_size_m) {
    const Eigen::Vector3d origin_m = grid.origin_voxels * grid.voxel_size_m;
    const Eigen::Vector3d sensor_m = scan.map_from_sensor.translation() - origin_m;
    sensor_ = sensor_m.cast<float>();
    sensor_voxel_ = voxel_at(sensor_, voxels_per_m_);
    const Eigen::Matrix3d rotation = scan.map_from_sensor.linear();
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3d p(scan.points[i].x, scan.points[i].y, scan.points[i].z);
      const double range_sq_m2 = (p.x() * p.x() + p.y() * p.y()) + p.z() * p.z();
      const bool takes_part =
          range_sq_m2 > config.min_range_m * config.min_range_m && std::isfinite(range_sq_m2);
      if (!takes_part) continue;
      lines_.push_back(line_to((rotation * p + sensor_m).cast<float>()));
      point_of_line_.push_back(i);
    }
  }

  std::span<const Line> all() const { return lines_; }
  std::size_t point_of(std::size_t line) const { return point_of_line_[line]; }

  VoxelBox box() const {
    VoxelBox box{sensor_voxel_, sensor_voxel_};
    for (const Line& line : lines_) box.include(line.end_voxel);
    box.widen(1);  // rounding may lead a ray past its end
    return box;
  }

  /// Appends the ray of a line that leaves the sensor's voxel.
  void append_ray(const Line& line, const Voxel& corner, const WindowBits& bits,
                  std::vector<ExactRay>& rays) const {
    if (line.end_voxel == sensor_voxel_) return;
    Eigen::Vector3f direction = line.end - sensor_;
    const auto length_m = static_cast<float>(norm_of(direction));
    direction /= length_m;
    const auto bit_of = [&](const Voxel& v) {
      return bits.at({v.x - corner.x, v.y - corner.y, v.z - corner.z});
    };
    const Voxel& end = line.end_voxel;
    const int steps = std::abs(end.x - sensor_voxel_.x) + std::abs(end.y - sensor_voxel_.y) +
                      std::abs(end.z - sensor_voxel_.z);
    rays.push_back({BorderCrossings(sensor_.cast<double>(), direction.cast<double>(), sensor_voxel_,
                                    config_.voxel_size_m),
                    length_m, bit_of(sensor_voxel_), bit_of(end),
                    static_cast<std::uint32_t>(steps)});
  }

 private:
  Line line_to(const Eigen::Vector3f& point) const {
    Eigen::Vector3f direction = point - sensor_;
    const double length_m = norm_of(direction);
    if (length_m <= config_.max_range_m) return {point, voxel_at(point, voxels_per_m_), false};
    direction /= static_cast<float>(length_m);
    const Eigen::Vector3f end = sensor_ + direction * static_cast<float>(config_.max_range_m);
    return {end, voxel_at(end, voxels_per_m_), true};
  }

  const Config& config_;
  double voxels_per_m_;
  Eigen::Vector3f sensor_;
  Voxel sensor_voxel_;
  std::vector<Line> lines_;
  std::vector<std::size_t> point_of_line_;
};

}  // namespace

ScanUpdate update_of(const PosedScan& scan, const VoxelGrid& grid, const Config& config,
                     std::vector<RayWindow>& windows, ThreadPool& pool) {
  const Lines lines(scan, grid, config);
  ScanUpdate update;
  update.voxel_of_point.assign(scan.points.size(), kNoVoxel);
  for (std::size_t i = 0; i < lines.all().size(); ++i) {
    const Line& line = lines.all()[i];
    if (line.cut) continue;
    const std::uint32_t slot = update.hit.insert(block_of(line.end_voxel));
    const std::uint32_t cell = cell_of(line.end_voxel);
    update.hit.masks[slot].set(cell);
    update.voxel_of_point[lines.point_of(i)] = slot * kBlockVoxels + cell;
  }
  if (lines.all().empty()) return update;

  windows.resize(pool.size());
  BlockIndex first;
  for (RayWindow& window : windows) first = lay_out_around(lines.box(), window);
  const Voxel corner = mosbench::voxel_at(first, 0);
  const WindowBits bits(windows.front());
  // Neighbouring points go to different shares, so that all take about as long.
  const std::size_t shares = 4 * pool.size();
  pool.for_ranges(shares, 1, [&](std::size_t share, std::size_t, unsigned thread) {
    std::vector<ExactRay> rays;
    for (std::size_t i = share; i < lines.all().size(); i += shares) {
      lines.append_ray(lines.all()[i], corner, bits, rays);
    }
    cast_exact(rays, RayEnd::kBeforeEnd, windows[thread], 0, windows[thread]);
  });
  update.free = collect(windows, first, pool);
  return update;
}

}  // namespace mosbench::octomap
