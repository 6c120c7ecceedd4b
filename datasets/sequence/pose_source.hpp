#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

#include "datasets/sequence/reading_options.hpp"

namespace mosbench {

/// The lidar's poses of a sequence, and how they were come by.
struct SettledPoses {
  std::vector<Pose> map_from_sensor;  ///< one per scan
  std::vector<std::filesystem::path> files;
  std::vector<std::string> remarks;
  ReadingStatement reading;
};

/// The scans that poses are wanted for.
struct PosedScans {
  std::size_t count = 0;
  std::span<const std::int64_t> stamps_ns;  ///< one per scan, or none
};

/// Reads `options.poses`, else `folder`/`own_file`, and turns the poses into the lidar's by
/// `folder`/calib.txt. Poses with stamps are taken at the scans' stamps, in between neighbours
/// interpolated; without stamps, row by row. Throws DataError when counts differ or the stamps of
/// the poses do not cover a scan.
SettledPoses settle_poses(const std::filesystem::path& folder, const std::string& own_file,
                          const ReadingOptions& options, const PosedScans& scans);

}  // namespace mosbench
