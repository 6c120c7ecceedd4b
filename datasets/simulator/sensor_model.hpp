#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/layouts/simulation.hpp"

namespace mosbench {

/// The mounting of a sensor on its carrier and the properties of its returns.
struct SensorModel {
  SensorKind kind = SensorKind::kOs1_64;
  std::size_t columns = 2048;  ///< firings per scan; those of a rosette fire 6 lasers each
  std::size_t rings = 64;      ///< lasers per firing
  double min_range_m = 0.3;    ///< nothing is measured nearer
  double max_range_m = 120.0;
  double range_noise_m = 0.02;  ///< standard deviation along the ray
  double dropout_probability = 0.01;
  Eigen::Vector3d mount_m = Eigen::Vector3d::Zero();  ///< in the carrier's frame (x ahead, z up)

  std::size_t slots() const { return columns * rings; }
};

std::string_view to_string(SensorKind kind);
/// Returns nothing when the name is not one of `sensor_names()`.
std::optional<SensorKind> sensor_kind_from_string(std::string_view name);
std::vector<std::string_view> sensor_names();

/// Returns the sensor as it is sold: OS1-64 2048 columns, OS2-128 1024, VLP-16 1800, HDL-64E 2000,
/// Livox Avia 24,000 points, Aeva Aeries II 64 x 800, HDL-32E 1084, Livox Mid-360 20,000 points.
SensorModel sensor_model(SensorKind kind);

/// Returns unit vectors of all rays of a scan in firing order, slot = column * rings + ring, in the
/// sensor frame (x ahead). Only the patterns of Livox depend on the scan: they do not repeat.
std::vector<Eigen::Vector3d> beam_directions(const SensorModel& sensor, std::size_t scan_index);
bool repeats_every_scan(const SensorModel& sensor);

}  // namespace mosbench
