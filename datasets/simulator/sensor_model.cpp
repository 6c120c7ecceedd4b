#include "datasets/simulator/sensor_model.hpp"

#include <algorithm>
#include <array>

#include "datasets/sequence/portable_math.hpp"

namespace mosbench {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadPerDeg = kPi / 180.0;

/// Elevations of the highest and lowest ring, and the horizontal field of view.
struct FieldOfView {
  double top_rad, bottom_rad, width_rad;
};

struct SensorRow {
  std::string_view name;
  FieldOfView view;
  SensorModel model;
};

/// In the order of SensorKind.
const std::array<SensorRow, 8>& sensor_rows() {
  static const std::array<SensorRow, 8> rows = {{
      {"os1-64", {16.61 * kRadPerDeg, -16.61 * kRadPerDeg, 2 * kPi}, {.kind = SensorKind::kOs1_64}},
      {"os2-128",
       {11.25 * kRadPerDeg, -11.25 * kRadPerDeg, 2 * kPi},
       {.kind = SensorKind::kOs2_128,
        .columns = 1024,
        .rings = 128,
        .min_range_m = 0.8,
        .max_range_m = 210.0,
        .range_noise_m = 0.03,
        .mount_m = {0.0, 0.0, 0.2}}},
      {"vlp-16",
       {15.0 * kRadPerDeg, -15.0 * kRadPerDeg, 2 * kPi},
       {.kind = SensorKind::kVlp16,
        .columns = 1800,
        .rings = 16,
        .min_range_m = 0.5,
        .max_range_m = 100.0,
        .mount_m = {-0.6, 0.0, 0.0}}},
      {"hdl-64e",
       {2.0 * kRadPerDeg, -24.8 * kRadPerDeg, 2 * kPi},
       {.kind = SensorKind::kHdl64e, .columns = 2000, .min_range_m = 0.9}},
      {"avia",
       {38.6 * kRadPerDeg, -38.6 * kRadPerDeg, 70.4 * kRadPerDeg},
       {.kind = SensorKind::kAvia,
        .columns = 4000,
        .rings = 6,
        .min_range_m = 1.0,
        .max_range_m = 190.0,
        .mount_m = {0.5, 0.3, 0.0}}},
      {"aeva",
       {9.6 * kRadPerDeg, -9.6 * kRadPerDeg, 120.0 * kRadPerDeg},
       {.kind = SensorKind::kAeva,
        .columns = 800,
        .min_range_m = 1.0,
        .max_range_m = 150.0,
        .range_noise_m = 0.03,
        .mount_m = {0.5, -0.3, 0.0}}},
      {"hdl-32e",
       {10.67 * kRadPerDeg, -30.67 * kRadPerDeg, 2 * kPi},
       {.kind = SensorKind::kHdl32e,
        .columns = 1084,
        .rings = 32,
        .min_range_m = 1.0,
        .max_range_m = 100.0}},
      {"mid-360",
       {52.0 * kRadPerDeg, -7.0 * kRadPerDeg, 2 * kPi},
       {.kind = SensorKind::kMid360,
        .columns = 5000,
        .rings = 4,
        .min_range_m = 0.1,
        .max_range_m = 70.0}},
  }};
  return rows;
}

const SensorRow& row_of(SensorKind kind) { return sensor_rows()[static_cast<std::size_t>(kind)]; }

Eigen::Vector3d direction(SinCos azimuth, SinCos elevation) {
  return {elevation.cos * azimuth.cos, elevation.cos * azimuth.sin, elevation.sin};
}

std::vector<Eigen::Vector3d> raster(const SensorModel& sensor) {
  const FieldOfView view = row_of(sensor.kind).view;
  const double columns = static_cast<double>(sensor.columns);
  const double ring_step_rad =
      (view.top_rad - view.bottom_rad) / static_cast<double>(sensor.rings - 1);
  std::vector<SinCos> elevations;
  for (std::size_t ring = 0; ring < sensor.rings; ++ring) {
    elevations.push_back(sin_cos(view.top_rad - static_cast<double>(ring) * ring_step_rad));
  }
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(sensor.slots());
  for (std::size_t column = 0; column < sensor.columns; ++column) {
    // Clockwise seen from above, the seam of a full turn at the back.
    const double turn = 0.5 - (static_cast<double>(column) + 0.5) / columns;
    const SinCos azimuth = sin_cos(turn * view.width_rad);
    for (const SinCos& elevation : elevations) rays.push_back(direction(azimuth, elevation));
  }
  return rays;
}

// Two counter-rotating prisms bend the beam twice. The turns per scan are incommensurable with the
// scan and with each other, which is why the pattern never repeats; six lasers lie side by side.
std::vector<Eigen::Vector3d> rosette(const SensorModel& sensor, std::size_t scan_index) {
  constexpr double kFirstTurnsPerScan = 12.1832, kSecondTurnsPerScan = -7.5297;
  constexpr double kLaserSpacingRad = 0.0045;
  const FieldOfView view = row_of(sensor.kind).view;
  const double spread_rad = kLaserSpacingRad * static_cast<double>(sensor.rings - 1) / 2;
  const double half_width_rad = view.width_rad / 2 - spread_rad;
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(sensor.slots());
  for (std::size_t column = 0; column < sensor.columns; ++column) {
    const double scans = static_cast<double>(scan_index) +
                         static_cast<double>(column) / static_cast<double>(sensor.columns);
    const SinCos first = sin_cos(2 * kPi * kFirstTurnsPerScan * scans);
    const SinCos second = sin_cos(2 * kPi * kSecondTurnsPerScan * scans);
    const SinCos elevation = sin_cos(view.top_rad * 0.5 * (first.sin + second.sin));
    const double azimuth_rad = half_width_rad * 0.5 * (first.cos + second.cos) - spread_rad;
    for (std::size_t laser = 0; laser < sensor.rings; ++laser) {
      const double offset_rad = static_cast<double>(laser) * kLaserSpacingRad;
      rays.push_back(direction(sin_cos(azimuth_rad + offset_rad), elevation));
    }
  }
  return rays;
}

// A mirror turns the beam all round while it nods, at rates that are incommensurable as well; four
// lasers lie side by side.
std::vector<Eigen::Vector3d> nodding_turns(const SensorModel& sensor, std::size_t scan_index) {
  constexpr double kTurnsPerScan = 5.0937, kNodsPerScan = 61.3709, kLaserSpacingRad = 0.0045;
  const FieldOfView view = row_of(sensor.kind).view;
  const double middle_rad = 0.5 * (view.top_rad + view.bottom_rad);
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(sensor.slots());
  for (std::size_t column = 0; column < sensor.columns; ++column) {
    const double scans = static_cast<double>(scan_index) +
                         static_cast<double>(column) / static_cast<double>(sensor.columns);
    const double nod = sin_cos(2 * kPi * kNodsPerScan * scans).sin;
    const SinCos elevation = sin_cos(middle_rad + (view.top_rad - middle_rad) * nod);
    for (std::size_t laser = 0; laser < sensor.rings; ++laser) {
      const double offset_rad = static_cast<double>(laser) * kLaserSpacingRad;
      rays.push_back(direction(sin_cos(offset_rad - 2 * kPi * kTurnsPerScan * scans), elevation));
    }
  }
  return rays;
}

}  // namespace

std::string_view to_string(SensorKind kind) { return row_of(kind).name; }

std::optional<SensorKind> sensor_kind_from_string(std::string_view name) {
  const auto row = std::ranges::find(sensor_rows(), name, &SensorRow::name);
  if (row == sensor_rows().end()) return std::nullopt;
  return row->model.kind;
}

std::vector<std::string_view> sensor_names() {
  std::vector<std::string_view> names;
  for (const SensorRow& row : sensor_rows()) names.push_back(row.name);
  return names;
}

SensorModel sensor_model(SensorKind kind) { return row_of(kind).model; }

std::vector<Eigen::Vector3d> beam_directions(const SensorModel& sensor, std::size_t scan_index) {
  if (repeats_every_scan(sensor)) return raster(sensor);
  return sensor.kind == SensorKind::kAvia ? rosette(sensor, scan_index)
                                          : nodding_turns(sensor, scan_index);
}

bool repeats_every_scan(const SensorModel& sensor) {
  return sensor.kind != SensorKind::kAvia && sensor.kind != SensorKind::kMid360;
}

}  // namespace mosbench
