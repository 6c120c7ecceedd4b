#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

#include "datasets/sequence/reading_options.hpp"
#include "datasets/sequence/recording.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

/// Scans have no poses at all, which odometry can find. Who knows what the user typed adds the
/// command.
class MissingPoses : public DataError {
 public:
  using DataError::DataError;
};

/// LiDAR poses of a sequence and where they came from.
struct SensorPoses {
  std::vector<Pose> map_from_sensor;  ///< one per scan
  std::vector<std::size_t> unknown;   ///< scans, in order, whose pose above says nothing
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
/// and scans are paired in order. Scans between poses more than `options.max_pose_gap_s` apart have
/// no pose. Throws MissingPoses where there is no file, DataError when counts differ, when the
/// stamps of the poses do not cover a scan, or when no scan has a pose. Identities where
/// `options.poses_by_odometry` is set.
SensorPoses read_sensor_poses(const std::filesystem::path& folder, const std::string& own_file,
                              const ReadingOptions& options, const PosedScans& scans);

/// Gives the scans of a recording, which have none yet, their poses, and leaves those out whose
/// pose is unknown.
void place_scans(const SensorPoses& poses, Recording& recording);
/// Adds where poses came from to what a recording says of itself.
void add_statements(const SensorPoses& poses, Recording& recording);

/// Beside poses that `convert` wrote: a line that says where they came from, and one with the hash
/// of the file that holds them.
inline constexpr const char* kPoseOriginFile = "pose_origin.txt";
/// Returns that file; of an .h5 file, which shares its folder with others, NAME.pose_origin.txt.
std::filesystem::path pose_origin_file(const std::filesystem::path& pose_file);

/// Returns the first line for the poses of a sequence that was read so.
std::string pose_origin_of(const ReadingStatement& reading);

/// Writes both lines beside `pose_file`, which is complete.
void write_pose_origin(const std::filesystem::path& pose_file, const std::string& origin);

/// Adds the line beside `pose_file`, if there is one, to what is said of the poses; a remark in its
/// place where the file is not the one that the line was written for.
void state_pose_origin(const std::filesystem::path& pose_file, ReadingStatement& reading,
                       std::vector<std::string>& remarks);

}  // namespace mosbench
