#include "datasets/layouts/kitti_drive.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/formats/tracklets.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFrames = 1'000'000;

std::size_t frame_of(const StemFile& file) {
  const auto number = stem_number(file.stem);
  if (!number || *number > kMostFrames) {
    throw DataError(file.file, "has no number of a frame for a name", "0000000000 and so on");
  }
  return static_cast<std::size_t>(*number);
}

std::vector<StemFile> list_frames(const fs::path& folder, const char* extension) {
  std::vector<StemFile> files = list_by_stem(folder, {extension});
  if (files.empty()) throw DataError(folder, "holds no frame", "files *" + std::string(extension));
  for (const StemFile& file : files) frame_of(file);
  return files;
}

/// map_from_lidar of packets, seen from the LiDAR of the first.
std::vector<Pose> lidar_poses(const std::vector<OxtsPacket>& packets, const Pose& lidar_from_imu) {
  std::vector<Pose> poses = poses_of_oxts(packets);
  const Pose imu_from_lidar = lidar_from_imu.inverse();
  for (Pose& pose : poses) pose = lidar_from_imu * pose * imu_from_lidar;
  return poses;
}

constexpr std::string_view kPart = "Object";

/// The instance that the type of a written box says, else that of its track.
std::uint32_t instance_of(std::string_view type, std::uint64_t track) {
  const bool is_part = type.starts_with(kPart);
  const auto part = is_part ? parse_unsigned(type.substr(kPart.size())) : std::nullopt;
  constexpr std::uint64_t kMost = 65535;
  return part && *part <= kMost ? static_cast<std::uint32_t>(*part) : instance_of_number(track);
}

BoxTrack track_of(const Tracklet& tracklet, std::size_t number) {
  BoxTrack track;
  const Eigen::Vector3d half_size_m =
      0.5 * Eigen::Vector3d(tracklet.length_m, tracklet.width_m, tracklet.height_m);
  for (std::size_t i = 0; i < tracklet.poses.size(); ++i) {
    const TrackletPose& at = tracklet.poses[i];
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(at.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.translation() = at.bottom_m + half_size_m.z() * Eigen::Vector3d::UnitZ();
    track.push_back(
        {tracklet.first_frame + i, pose, half_size_m, instance_of(tracklet.type, number)});
  }
  return track;
}

void read_raw_poses(const fs::path& folder, const Pose& lidar_from_imu, KittiDrive& drive) {
  std::vector<OxtsPacket> packets;
  const std::vector<StemFile> files = list_frames(folder / "data", ".txt");
  for (const StemFile& file : files) {
    const auto of_frame = parse_oxts(read_file(file.file), file.file);
    if (of_frame.size() != 1) throw DataError(file.file, "is no packet", "one line");
    packets.push_back(of_frame.front());
  }
  drive.pose_file = folder / "timestamps.txt";
  const auto stamps_ns = parse_kitti_stamps(read_file(drive.pose_file), drive.pose_file);
  const std::vector<Pose> poses = lidar_poses(packets, lidar_from_imu);
  drive.frames.resize(frame_of(files.back()) + 1);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::size_t frame = frame_of(files[i]);
    if (frame >= stamps_ns.size() || !stamps_ns[frame]) {
      throw DataError(drive.pose_file, fmt::format("has no stamp for frame {}", frame),
                      "a line for each, those that were not recorded empty");
    }
    drive.frames[frame] = {poses[i], *stamps_ns[frame]};
    drive.files.push_back(files[i].file);
  }
  drive.files.push_back(drive.pose_file);
}

void read_tracklets(const fs::path& file, KittiDrive& drive) {
  for (const Tracklet& tracklet : parse_tracklets(read_file(file), file)) {
    drive.tracks.push_back(track_of(tracklet, drive.tracks.size()));
  }
  drive.has_truth = true;
  drive.truth_files = {file};
}

/// The camera's x is the length at rotation 0, its -y is up.
Pose rectified_from_box(const CameraBox& box) {
  Pose pose = Pose::Identity();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(box.rotation_y_rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.linear() << turn.col(0), turn.col(2), -Eigen::Vector3d::UnitY();
  pose.translation() = box.bottom_m - 0.5 * box.height_m * Eigen::Vector3d::UnitY();
  return pose;
}

void read_labels_of_tracks(const fs::path& file, KittiDrive& drive) {
  std::map<std::int64_t, BoxTrack> tracks;
  const Pose lidar_from_rectified = drive.view.rectified_from_lidar.inverse();
  for (const TrackingLabel& label : parse_tracking_labels(read_file(file), file)) {
    if (!label.box) {
      drive.unlabelled[label.frame].push_back(label.region_px);
      continue;
    }
    const CameraBox& box = *label.box;
    tracks[label.track].push_back(
        {label.frame, lidar_from_rectified * rectified_from_box(box),
         0.5 * Eigen::Vector3d(box.length_m, box.width_m, box.height_m),
         instance_of(label.type, static_cast<std::uint64_t>(label.track))});
  }
  for (auto& [number, track] : tracks) {
    std::ranges::sort(track, {}, &TrackedBox::frame);
    drive.tracks.push_back(std::move(track));
  }
  drive.has_truth = true;
  drive.truth_files = {file};
}

fs::path first_missing(const std::vector<fs::path>& needed) {
  const auto missing = std::ranges::find_if_not(needed, is_there);
  return missing == needed.end() ? fs::path() : *missing;
}

/// Whether there are boxes, and poses by which they move.
bool has_usable_boxes(const fs::path& file, KittiDrive& drive) {
  if (!is_there(file)) {
    drive.remarks.emplace_back("no labels of objects: there is no truth");
    return false;
  }
  if (drive.missing.empty()) return true;
  drive.remarks.push_back(
      fmt::format("{} gives no truth: {} is not there, by which its boxes have a place and a speed",
                  file.string(), drive.missing.string()));
  return false;
}

}  // namespace

std::string type_of_part(std::uint32_t instance) { return fmt::format("{}{}", kPart, instance); }

KittiDrive read_raw_drive(const std::string& name, const fs::path& folder) {
  KittiDrive drive;
  drive.name = name;
  drive.folder = folder;
  drive.scans = list_frames(folder / "velodyne_points/data", ".bin");
  drive.pose_source = "oxts, by Mercator's projection";
  drive.truth_source = "tracklet_labels.xml";
  const fs::path tracklets = folder / "tracklet_labels.xml", stamps = folder / "velodyne_points";
  const fs::path date = parent_folder(folder);
  drive.missing = first_missing({folder / "oxts", date / "calib_imu_to_velo.txt",
                                 date / "calib_velo_to_cam.txt", date / "calib_cam_to_cam.txt"});
  if (drive.missing.empty()) {
    const KittiMounting mounting = read_kitti_mounting(date);
    drive.view = mounting.view;
    for (const char* calib : {"imu_to_velo", "velo_to_cam", "cam_to_cam"}) {
      drive.files.push_back(date / fmt::format("calib_{}.txt", calib));
    }
    read_raw_poses(folder / "oxts", mounting.lidar_from_imu, drive);
  }
  if (has_usable_boxes(tracklets, drive)) read_tracklets(tracklets, drive);
  if (is_there(stamps / "timestamps.txt")) {
    drive.files.push_back(stamps / "timestamps.txt");
    drive.stamps_ns = parse_kitti_stamps(read_file(drive.files.back()), drive.files.back());
    for (const StemFile& scan : drive.scans) {
      const std::size_t frame = frame_of(scan);
      if (frame < drive.stamps_ns.size() && drive.stamps_ns[frame]) continue;
      throw DataError(drive.files.back(), fmt::format("has no stamp for frame {}", frame),
                      "a line for each, those that were not recorded empty");
    }
  }
  return drive;
}

KittiDrive read_tracking_drive(const std::string& name, const fs::path& folder) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  KittiDrive drive;
  drive.name = name;
  drive.folder = folder;
  drive.scans = list_frames(folder, ".bin");
  drive.pose_source = "oxts, by Mercator's projection";
  drive.truth_source = "label_02, frames 0.1 s apart";
  const fs::path root = parent_folder(parent_folder(folder));
  const std::string file_name = folder_name(folder) + ".txt";
  const fs::path calib = root / "calib" / file_name, labels = root / "label_02" / file_name;
  drive.pose_file = root / "oxts" / file_name;
  drive.missing = first_missing({root / "oxts", root / "calib", drive.pose_file, calib});
  if (drive.missing.empty()) {
    const KittiMounting mounting = parse_tracking_calib(read_file(calib), calib);
    drive.view = mounting.view;
    const auto packets = parse_oxts(read_file(drive.pose_file), drive.pose_file);
    for (const Pose& pose : lidar_poses(packets, mounting.lidar_from_imu)) {
      const auto stamp_ns = static_cast<std::int64_t>(drive.frames.size()) * kPeriod_ns;
      drive.frames.push_back(FramePose{pose, stamp_ns});
    }
    drive.files = {calib, drive.pose_file};
  }
  if (has_usable_boxes(labels, drive)) read_labels_of_tracks(labels, drive);
  return drive;
}

}  // namespace mosbench
