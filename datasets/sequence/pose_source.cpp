#include "datasets/sequence/pose_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "datasets/disk/files.hpp"
#include "datasets/formats/calib_file.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/sequence/pose_frame_mark.hpp"
#include "datasets/sequence/pose_track.hpp"
#include "datasets/text/counted.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

double seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) * 1e-9; }

PoseTrack track_of(const PoseList& list) {
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (std::size_t i = 0; i < list.poses.size(); ++i) {
    stamped.emplace_back(list.stamps_ns[i], list.poses[i]);
  }
  return PoseTrack(std::move(stamped));
}

Pose pose_at(const PoseTrack& track, std::int64_t stamp_ns, const fs::path& file) {
  if (const auto pose = track.at(stamp_ns)) return *pose;
  throw DataError(file, fmt::format("holds no pose around the scan of {:.6f} s", seconds(stamp_ns)),
                  track.empty() ? "poses"
                                : fmt::format("stamps that cover all scans, not {:.6f} to {:.6f} s",
                                              seconds(track.first_ns()), seconds(track.last_ns())));
}

std::string hash_line(const fs::path& pose_file) {
  return fmt::format("XXH3-128 of {}: {}\n", pose_file.filename().string(),
                     hash_of_file(pose_file));
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
    if (!options_.poses) state_pose_origin(file_, result_.reading, result_.remarks);
    return std::move(result_);
  }

 private:
  void state(const char* what, std::string how) {
    result_.reading.emplace_back(what, std::move(how));
  }

  void pair_with_scans(const PoseList& list, const PosedScans& scans) {
    if (!list.stamps_ns.empty() && !scans.stamps_ns.empty()) {
      interpolate(track_of(list), scans);
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

  /// Takes the poses at the stamps of the scans.
  void interpolate(const PoseTrack& track, const PosedScans& scans) {
    std::size_t interpolated = 0;
    for (const std::int64_t stamp_ns : scans.stamps_ns) {
      result_.map_from_sensor.push_back(pose_at(track, stamp_ns, file_));
      const std::int64_t gap_ns = track.gap_ns(stamp_ns);
      if (gap_ns == 0) continue;
      if (static_cast<double>(gap_ns) <= std::round(options_.max_pose_gap_s * 1e9)) {
        ++interpolated;
      } else {
        result_.unknown.push_back(result_.map_from_sensor.size() - 1);
      }
    }
    std::string how = fmt::format("by stamp, {} of {} interpolated", interpolated, scans.count);
    if (!result_.unknown.empty()) how += "; " + state_gaps(scans);
    state("pose_pairing", std::move(how));
  }

  std::string state_gaps(const PosedScans& scans) {
    const std::string gaps =
        fmt::format("lie between poses more than {:g} s apart", options_.max_pose_gap_s);
    if (result_.unknown.size() == scans.count) {
      throw DataError(file_, "all scans " + gaps, "more poses, or a longer --max-pose-gap-s");
    }
    const std::string left_out =
        fmt::format("{} of {} are left out", result_.unknown.size(), counted(scans.count, "scan"));
    result_.remarks.push_back(fmt::format("{}: they {} in {} (--max-pose-gap-s)", left_out, gaps,
                                          file_.filename().string()));
    return left_out;
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
    const bool by_calib =
        options_.pose_frame == PoseFrame::kByCalib && format == PoseFormat::kKitti;
    const bool of_camera = options_.pose_frame == PoseFrame::kCamera || by_calib;
    if (!of_camera || is_identity(camera_from_lidar)) {
      state("pose_frame", "lidar");
      return;
    }
    if (by_calib && is_marked_as_lidars(file_)) {
      state("pose_frame", "lidar, as the .frame beside the file says");
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

/// Says where poses are expected, and names those that lie where KITTI's odometry benchmark has
/// them: poses/04.txt beside sequences/04.
MissingPoses missing_poses(const fs::path& folder, const fs::path& file) {
  const fs::path name = fs::absolute(folder / "").parent_path().filename();
  const fs::path others = folder / "../../poses";
  const std::string expected =
      is_there(others / (name.string() + ".txt"))
          ? fmt::format("one pose per scan there, or --poses {}",
                        others.lexically_normal().string())
          : "one pose per scan there, in a file given by --poses, or found by odometry";
  return {file, "does not exist", expected};
}

}  // namespace

std::string pose_origin_of(const ReadingStatement& reading) {
  std::string origin;
  for (const auto& [what, how] : reading) {
    if (what == "pose_origin") return how;  // of poses that were converted before
    if (what != "poses" && !what.starts_with("pose_")) continue;
    origin += fmt::format("{}{}: {}", origin.empty() ? "" : "; ", what, how);
  }
  std::ranges::replace(origin, '\n', ' ');
  return origin;
}

void place_scans(const SensorPoses& poses, Recording& recording) {
  std::vector<ScanEntry> scans = std::exchange(recording.scans, {});
  for (std::size_t k = 0; k < scans.size(); ++k) {
    scans[k].map_from_sensor = poses.map_from_sensor[k];
    const bool leaves_out = std::ranges::binary_search(poses.unknown, k);
    (leaves_out ? recording.left_out : recording.scans).push_back(std::move(scans[k]));
  }
}

void add_statements(const SensorPoses& poses, Recording& recording) {
  recording.files.insert(recording.files.end(), poses.files.begin(), poses.files.end());
  recording.remarks.insert(recording.remarks.end(), poses.remarks.begin(), poses.remarks.end());
  recording.reading.insert(recording.reading.end(), poses.reading.begin(), poses.reading.end());
}

fs::path pose_origin_file(const fs::path& pose_file) {
  if (pose_file.extension() != ".h5") return pose_file.parent_path() / kPoseOriginFile;
  return pose_file.parent_path() / (pose_file.stem().string() + "." + kPoseOriginFile);
}

void write_pose_origin(const fs::path& pose_file, const std::string& origin) {
  write_file_atomic(pose_origin_file(pose_file), origin + "\n" + hash_line(pose_file));
}

void state_pose_origin(const fs::path& pose_file, ReadingStatement& reading,
                       std::vector<std::string>& remarks) {
  const fs::path file = pose_origin_file(pose_file);
  if (!is_there(file)) return;
  const std::string text = read_file(file);
  const std::string origin = text.substr(0, text.find('\n'));
  if (text == origin + "\n" + hash_line(pose_file)) {
    reading.emplace_back("pose_origin", origin);
  } else {
    remarks.push_back(fmt::format(
        "{} was not written for {} as it is now: where these poses came from is not known",
        file.filename().string(), pose_file.filename().string()));
  }
}

SensorPoses read_sensor_poses(const fs::path& folder, const std::string& own_file,
                              const ReadingOptions& options, const PosedScans& scans) {
  if (options.poses_by_odometry) {
    return {.map_from_sensor = std::vector<Pose>(scans.count, Pose::Identity()),
            .unknown = {},
            .files = {},
            .remarks = {},
            .reading = {{"poses", "none"}}};
  }
  const fs::path file = options.poses.value_or(folder / own_file);
  if (!options.poses && !is_there(file)) {
    throw missing_poses(folder, file);
  }
  SensorPoses poses = SensorPoseReader(folder, options, file).run(scans);
  if (options.poses) {
    poses.remarks.insert(poses.remarks.begin(), "poses from " + file.string());
  }
  return poses;
}

}  // namespace mosbench
