#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/pose_track.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

/// Returns whether so few of many scans have poses that these are not meant for them.
bool are_too_few(std::size_t posed, std::size_t scans);

/// Scans have no poses at all, which odometry can find. Who knows what the user typed adds the
/// command.
class MissingPoses : public DataError {
 public:
  using DataError::DataError;
  bool of_some = false;  ///< the others have poses
};

/// LiDAR poses of the scans of a sequence and where they came from.
struct SensorPoses {
  std::vector<std::optional<Pose>> map_from_sensor;  ///< one per scan; nothing where not known
  std::vector<std::filesystem::path> files = {};
  std::vector<std::string> remarks = {}, doubts = {};  ///< as of a Recording
  PosesDone done = {};
};

/// Gives the scans of a recording, which have none yet, the poses that were asked for. They are
/// those of the user's file, else of `folder`/`own_file`, and are turned into the LiDAR's by
/// `folder`/calib.txt. Poses with stamps are interpolated to the scans' stamps; without stamps rows
/// and scans are paired in order. Scans between poses more than `asked.max_pose_gap_s` apart have
/// no pose: they are left out, without truth. All scans have the identity where odometry is to find
/// poses. Returns the indices of the scans that stay. Throws MissingPoses where there is no file,
/// DataError when counts differ, when the stamps of the poses do not cover a scan, or when no scan
/// has a pose.
std::vector<std::size_t> place_scans(const std::filesystem::path& folder,
                                     const std::string& own_file, const Reading& asked,
                                     Recording& recording);
/// The same by poses that are known, as those that a data set has of its own.
std::vector<std::size_t> place_scans(SensorPoses poses, Recording& recording);

/// Returns what is said of poses that a data set itself has of the LiDAR, and kept in `file`.
SensorPoses own_poses(std::string source, const std::filesystem::path& file);

/// Beside poses that `convert` wrote: a line that says where they came from, and one with the hash
/// of the file that holds them.
inline constexpr const char* kPoseOriginFile = "pose_origin.txt";
/// Returns that file; of an .h5 file, which shares its folder with others, NAME.pose_origin.txt.
std::filesystem::path pose_origin_file(const std::filesystem::path& pose_file);

/// Returns the first line for poses that came about so.
std::string pose_origin_of(const PosesDone& poses);

/// Writes both lines beside `pose_file`, which is complete, and a line for each doubt.
void write_pose_origin(const std::filesystem::path& pose_file, const std::string& origin,
                       const std::vector<std::string>& doubts = {});

/// Adds the lines beside `pose_file`, if there are any, to what is said of the poses; a doubt in
/// their place where the file is not the one that they were written for.
void state_pose_origin(const std::filesystem::path& pose_file, PosesDone& poses,
                       std::vector<std::string>& doubts);

}  // namespace mosbench
