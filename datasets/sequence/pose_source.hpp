#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

#include "datasets/sequence/reading_options.hpp"

namespace mosbench {

/// LiDAR poses of a sequence and where they came from.
struct SensorPoses {
  std::vector<Pose> map_from_sensor;  ///< one per scan
  std::vector<std::filesystem::path> files;
  std::vector<std::string> remarks;
  ReadingStatement reading;
};

/// The scans that need poses.
struct PosedScans {
  std::size_t count = 0;
  std::span<const std::int64_t> stamps_ns;  ///< one per scan, or none
};

/// Reads `options.poses`, else `folder`/`own_file`, and turns the poses into the LiDAR's by
/// `folder`/calib.txt. Poses with stamps are interpolated to the scans' stamps; without stamps rows
/// and scans are paired in order. Throws DataError when counts differ or the stamps of the poses do
/// not cover a scan. Identities where `options.poses_by_odometry` is set.
SensorPoses read_sensor_poses(const std::filesystem::path& folder, const std::string& own_file,
                              const ReadingOptions& options, const PosedScans& scans);

}  // namespace mosbench
