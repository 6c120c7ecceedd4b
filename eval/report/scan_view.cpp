#include "eval/report/scan_view.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace mosbench {
namespace {

constexpr double kElevation_rad = std::numbers::pi / 6.0;
/// Distance of the camera from the sensor in ranges: near enough for depth, far enough for all.
constexpr double kRangesAway = 1.6;
/// What is nearer than this share of it hides the picture.
constexpr double kNearest = 0.05;

}  // namespace

ScanView::ScanView(const ScanViewpoint& viewpoint, double range_m, double size_pixels)
    : orbits_(viewpoint.orbit_rad.has_value()),
      middle_(size_pixels / 2.0),
      pixels_per_m_(middle_ / range_m) {
  if (!orbits_) return;
  away_m_ = kRangesAway * range_m;
  const double azimuth_rad = *viewpoint.orbit_rad;
  const Eigen::Vector3d forward(std::cos(azimuth_rad) * std::cos(kElevation_rad),
                                std::sin(azimuth_rad) * std::cos(kElevation_rad),
                                -std::sin(kElevation_rad));
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  camera_from_sensor_.row(0) = right;
  camera_from_sensor_.row(1) = right.cross(forward);
  camera_from_sensor_.row(2) = forward;
}

std::optional<ViewedPoint> ScanView::seen(const Eigen::Vector3d& point_m) const {
  if (!orbits_) {
    return ViewedPoint{middle_ - point_m.y() * pixels_per_m_, middle_ - point_m.x() * pixels_per_m_,
                       0.0, 1.0};
  }
  const Eigen::Vector3d in_camera = camera_from_sensor_ * point_m;
  const double distance_m = in_camera.z() + away_m_;
  if (distance_m < kNearest * away_m_) return std::nullopt;
  const double scale = away_m_ / distance_m;
  return ViewedPoint{middle_ + in_camera.x() * pixels_per_m_ * scale,
                     middle_ - in_camera.y() * pixels_per_m_ * scale, distance_m, scale};
}

}  // namespace mosbench
