#pragma once

#include <array>
#include <string_view>

#include "core/base/fields.hpp"
#include "core/base/method_row.hpp"

namespace mosbench::odometry {

/// How the derivatives of SiMpLE's cost are found: by central differences as the authors' program
/// does, or by the formula with nearest neighbours held fixed.
enum class Gradient { kNumeric, kAnalytic };
inline constexpr std::array<std::string_view, 2> kGradientNames = {"numeric", "analytic"};

/// How scans with a time per point are corrected: not at all, by the motion of the scan before, or
/// by the motion that a first registration found, followed by a second one.
enum class Deskew { kNone, kVelocity, kPoses };
inline constexpr std::array<std::string_view, 3> kDeskewNames = {"none", "velocity", "poses"};

enum class Switch { kOff, kOn };
inline constexpr std::array<std::string_view, 2> kSwitchNames = {"off", "on"};

/// The settings that both engines share: which points take part, and when a pose is doubted.
struct ScanConfig {
  double min_range_m = 0.5;
  double max_range_m = 80.0;
  Switch kitti_correction = Switch::kOff;
  Deskew deskew = Deskew::kVelocity;
  double scan_period_s = 0.1;
  int min_points = 100;
  double min_overlap = 0.3;
  double min_geometry = 0.015;
  double max_acceleration_m_s2 = 3.0;
  double max_jump_m = 0.3;
};

template <typename AnyConfig, typename Visitor>
void visit_scan_fields(AnyConfig& config, Visitor&& visit) {
  visit("min_range_m", config.min_range_m, FieldRange{0.0, 1000.0},
        "points at or nearer than this take no part");
  visit("max_range_m", config.max_range_m, FieldRange{0.1, 1000.0},
        "points at or farther than this take no part; map points neither");
  visit("kitti_correction", config.kitti_correction, kSwitchNames,
        "raises points by 0.205 degrees, for KITTI's HDL-64E");
  visit("deskew", config.deskew, kDeskewNames,
        "motion by which scans with a time per point are corrected");
  visit("scan_period_s", config.scan_period_s, FieldRange{0.001, 100.0},
        "time between scans that have no stamps");
  visit("min_points", config.min_points, FieldRange{10, 1000000},
        "scans with fewer points after thinning are not registered");
  visit("min_overlap", config.min_overlap, FieldRange{0.0, 1.0},
        "poses of scans with a smaller share of points in the map are doubted");
  visit("min_geometry", config.min_geometry, FieldRange{0.0, 1.0},
        "poses of scans whose surfaces constrain a direction less are doubted");
  visit("max_acceleration_m_s2", config.max_acceleration_m_s2, FieldRange{0.01, 10000.0},
        "of the sensor between scans");
  visit("max_jump_m", config.max_jump_m, FieldRange{0.0, 1000.0},
        "poses farther off constant velocity than this and the acceleration are doubted");
}

/// SiMpLE (IJRR 2024); the defaults are the authors' of their online settings.
struct SimpleConfig {
  ScanConfig scan;
  Gradient gradient = Gradient::kAnalytic;
  double sigma_m = 0.3;        ///< width of the Gaussian that rewards closeness
  double map_radius_m = 2.0;   ///< r_map, least distance of map points
  double scan_radius_m = 0.5;  ///< r_new, least distance of scan points
  double tolerance = 1e-3;     ///< change of the cost, in points, that ends the search
};

template <typename AnyConfig, typename Visitor>
requires requires(AnyConfig& config) { config.scan_radius_m; }
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("gradient", config.gradient, kGradientNames,
        "derivatives as the authors' program takes them, or by formula and fast");
  visit("sigma_m", config.sigma_m, FieldRange{0.01, 100.0},
        "width of the Gaussian that rewards closeness to the map");
  visit("map_radius_m", config.map_radius_m, FieldRange{0.05, 100.0},
        "r_map, least distance between map points");
  visit("scan_radius_m", config.scan_radius_m, FieldRange{0.01, 100.0},
        "r_new, least distance between scan points");
  visit("tolerance", config.tolerance, FieldRange{1e-12, 1000.0},
        "change of the cost, in points, that ends the search");
  visit_scan_fields(config.scan, visit);
}

/// The KISS-ICP kind (RA-L 2023); the defaults are those of its authors' program.
struct KissConfig {
  ScanConfig scan = {.max_range_m = 100.0};
  double voxel_size_m = 1.0;
  int max_points_per_voxel = 20;
  double initial_threshold_m = 2.0;
  double min_motion_m = 0.1;
  int max_iterations = 500;
  double convergence = 1e-4;
};

template <typename AnyConfig, typename Visitor>
requires requires(AnyConfig& config) { config.max_points_per_voxel; }
void visit_fields(AnyConfig& config, Visitor&& visit) {
  visit("voxel_size_m", config.voxel_size_m, FieldRange{0.05, 100.0}, "edge of the map's voxels");
  visit("max_points_per_voxel", config.max_points_per_voxel, FieldRange{1, 1000},
        "points that a voxel of the map holds at most");
  visit("initial_threshold_m", config.initial_threshold_m, FieldRange{0.01, 100.0},
        "sigma before anything moved; neighbours count up to 3 sigma");
  visit("min_motion_m", config.min_motion_m, FieldRange{0.0, 100.0},
        "errors of the prediction up to this do not change sigma");
  visit("max_iterations", config.max_iterations, FieldRange{1, 100000},
        "Gauss-Newton steps per scan at most");
  visit("convergence", config.convergence, FieldRange{1e-12, 1.0},
        "length of a step, in radians and metres, that ends the search");
  visit_scan_fields(config.scan, visit);
}

/// Throws std::invalid_argument "<key>: <what is wrong>, <what was expected>" for a field outside
/// its range and for range limits that leave nothing.
template <typename Config>
void check(const Config& config) {
  check_ranges(config);
  check_range_limits(config.scan.min_range_m, config.scan.max_range_m);
}

}  // namespace mosbench::odometry
