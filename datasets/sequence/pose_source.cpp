#include "datasets/sequence/pose_source.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/files/calib_file.hpp"
#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/sequence/pose_track.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

/// Returns poses at the scan stamps; `interpolated` counts the stamps without an exact match.
std::vector<Pose> at_scan_stamps(const PoseList& list, const PosedScans& scans,
                                 std::size_t& interpolated, const fs::path& file) {
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (std::size_t i = 0; i < list.poses.size(); ++i) {
    stamped.emplace_back(list.stamps_ns[i], list.poses[i]);
  }
  const PoseTrack track(std::move(stamped));
  std::vector<Pose> poses;
  for (const std::int64_t stamp_ns : scans.stamps_ns) {
    const auto pose = track.at(stamp_ns);
    if (!pose) {
      throw DataError(file,
                      fmt::format("holds no pose around the scan of {:.6f} s",
                                  static_cast<double>(stamp_ns) * 1e-9),
                      track.empty() ? "poses"
                                    : fmt::format("stamps that cover all scans, not {:.6f} to "
                                                  "{:.6f} s",
                                                  static_cast<double>(track.first_ns()) * 1e-9,
                                                  static_cast<double>(track.last_ns()) * 1e-9));
    }
    if (!std::binary_search(list.stamps_ns.begin(), list.stamps_ns.end(), stamp_ns)) {
      ++interpolated;
    }
    poses.push_back(*pose);
  }
  return poses;
}

class SensorPoseReader {
 public:
  SensorPoseReader(const fs::path& folder, const ReadingOptions& options, fs::path file)
      : folder_(folder), options_(options), file_(std::move(file)) {}

  SensorPoses run(const PosedScans& scans) {
    const PoseList list = read_pose_list(file_, options_.pose_format);
    result_.files.push_back(file_);
    state("poses", options_.poses ? file_.string() : file_.filename().string());
    state("pose_format", std::string(to_string(list.format)));
    pair_with_scans(list, scans);
    invert_if(options_.poses_inverse.value_or(list.format == PoseFormat::kRollout));
    move_to_lidar(list.format);
    return std::move(result_);
  }

 private:
  void state(const char* what, std::string how) {
    result_.reading.emplace_back(what, std::move(how));
  }

  void pair_with_scans(const PoseList& list, const PosedScans& scans) {
    if (!list.stamps_ns.empty() && !scans.stamps_ns.empty()) {
      std::size_t interpolated = 0;
      result_.map_from_sensor = at_scan_stamps(list, scans, interpolated, file_);
      state("pose_pairing",
            fmt::format("by stamp, {} of {} interpolated", interpolated, scans.count));
      return;
    }
    if (list.poses.size() != scans.count) {
      throw DataError(file_,
                      fmt::format("{} pose rows for {} scans", list.poses.size(), scans.count),
                      "one per scan");
    }
    result_.map_from_sensor = list.poses;
    state("pose_pairing", "row by row");
  }

  void invert_if(bool inverse) {
    state("pose_direction", inverse ? "sensor_from_map, inverted" : "map_from_sensor");
    if (!inverse) return;
    for (Pose& pose : result_.map_from_sensor) pose = pose.inverse();
    result_.remarks.push_back(file_.filename().string() +
                              " is read as sensor_from_map: its poses are inverted");
  }

  void move_to_lidar(PoseFormat format) {
    const fs::path calib = folder_ / "calib.txt";
    if (!is_there(calib)) {
      if (options_.pose_frame == PoseFrame::kCamera) {
        throw DataError(calib, "does not exist", "Tr there, as the poses are those of a camera");
      }
      result_.remarks.push_back("no calib.txt: the poses are read as the lidar's");
      state("pose_frame", "lidar");
      return;
    }
    const Pose camera_from_lidar = read_calib(calib);
    result_.files.push_back(calib);
    const bool of_camera =
        options_.pose_frame == PoseFrame::kCamera ||
        (options_.pose_frame == PoseFrame::kByCalib && format == PoseFormat::kKitti);
    if (!of_camera || is_identity(camera_from_lidar)) {
      state("pose_frame", "lidar");
      return;
    }
    for (Pose& pose : result_.map_from_sensor) pose = lidar_pose(pose, camera_from_lidar);
    state("pose_frame", "camera, turned into the lidar's by Tr of calib.txt");
    result_.remarks.push_back(fmt::format(
        "calib.txt holds a Tr other than the identity: {} is read as camera poses, lidar pose = "
        "Tr^-1 * P * Tr (KITTI)",
        file_.filename().string()));
  }

  const fs::path& folder_;
  const ReadingOptions& options_;
  fs::path file_;
  SensorPoses result_;
};

}  // namespace

SensorPoses read_sensor_poses(const fs::path& folder, const std::string& own_file,
                              const ReadingOptions& options, const PosedScans& scans) {
  if (options.poses_by_odometry) {
    return {.map_from_sensor = std::vector<Pose>(scans.count, Pose::Identity()),
            .files = {},
            .remarks = {},
            .reading = {{"poses", "none"}}};
  }
  const fs::path file = options.poses.value_or(folder / own_file);
  if (!options.poses && !is_there(file)) {
    throw DataError(
        file, "does not exist",
        "one pose per scan there, in a file given by --poses, or found by --odometry simple");
  }
  SensorPoses poses = SensorPoseReader(folder, options, file).run(scans);
  if (options.poses) {
    poses.remarks.insert(poses.remarks.begin(), "poses from " + file.string());
  }
  return poses;
}

}  // namespace mosbench
