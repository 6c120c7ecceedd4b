#pragma once

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <string>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_file.hpp"
#include "datasets/formats/pose_file.hpp"

/// A sequence folder in SemanticKITTI's layout, small enough for a test of its own: a box that
/// crosses a square room around a sensor that stands still.
namespace mosbench::cli {

inline constexpr std::size_t kRays = 360;
inline constexpr std::size_t kRows = 24;
inline constexpr std::size_t kPointsPerScan = kRays * kRows;

inline std::string stem(std::size_t scan_index) {
  const std::string digits = std::to_string(scan_index);
  return std::string(6 - digits.size(), '0') + digits;
}

/// Where the ray in direction `azimuth_rad` ends in a room of 12 m with the box at `box_y_m`.
inline Point cast(double azimuth_rad, double height_m, double box_y_m, bool& moving) {
  const double x = std::cos(azimuth_rad);
  const double y = std::sin(azimuth_rad);
  double range_m = 6.0 / std::max(std::abs(x), std::abs(y));
  const double box_range_m = x > 0.0 ? 3.0 / x : range_m;
  moving = box_range_m < range_m && std::abs(box_range_m * y - box_y_m) < 0.6;
  if (moving) range_m = box_range_m;
  return {static_cast<float>(range_m * x), static_cast<float>(range_m * y),
          static_cast<float>(height_m), 0.5F};
}

/// Other scans of the crossing where it is further on from the first.
inline void write_small_sequence(const std::filesystem::path& folder, std::size_t scans,
                                 std::size_t further = 0) {
  for (std::size_t k = 0; k < scans; ++k) {
    std::vector<Point> points;
    std::vector<std::uint32_t> truth;
    for (std::size_t i = 0; i < kPointsPerScan; ++i) {
      bool moving = false;
      const double azimuth_rad = 6.283185307179586 / kRays * (0.5 + static_cast<double>(i / kRows));
      const double height_m = 0.2 * static_cast<double>(i % kRows) - 2.3;
      points.push_back(cast(azimuth_rad, height_m,
                            -2.5 + 0.2 * static_cast<double>((k + further) % 26), moving));
      truth.push_back(moving ? kMovingLabel : kStaticLabel);
    }
    write_bin(folder / "velodyne" / (stem(k) + ".bin"), points);
    write_labels(folder / "labels" / (stem(k) + ".label"), truth);
  }
  write_poses(folder / "poses.txt", std::vector<Pose>(scans, Pose::Identity()));
  write_file_atomic(folder / "calib.txt", "Tr: 1 0 0 0 0 1 0 0 0 0 1 0\n");
}

}  // namespace mosbench::cli
