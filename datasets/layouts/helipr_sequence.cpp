#include "datasets/layouts/helipr_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/pose_track.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

HeliprSensor sensor_of_folder(const std::filesystem::path& folder) {
  const auto sensor = helipr_sensor_from_string(folder_name(folder));
  if (!sensor) throw DataError(folder, "is no LiDAR of HeLiPR", "Aeva, Avia, Ouster or Velodyne");
  return *sensor;
}

}  // namespace

HeliprSequence::HeliprSequence(std::string name, const std::filesystem::path& folder,
                               const Reading& asked)
    : sensor_(sensor_of_folder(folder)),
      gives_times_(asked.undistorts() && asked.point_times == PointTimes::kColumn) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), folder);
  recording.reading.scan_files = fmt::format(".bin of {}, packed", to_string(sensor_));
  recording.has_radial_velocities = sensor_ == HeliprSensor::kAeva;
  if (gives_times_) recording.reading.point_times = "of each point";
  recording.remarks = {"no truth: HeLiMOS labels part of KAIST05"};
  list_scans(folder);
  take_poses(folder, asked);
}

void HeliprSequence::list_scans(const std::filesystem::path& folder) {
  constexpr auto kLatest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  for (const StemFile& scan : list_by_stem(folder, {".bin"})) {
    const auto stamp_ns = stem_number(scan.stem);
    if (!stamp_ns || *stamp_ns > kLatest) {
      throw DataError(scan.file, "has no stamp for a name", "nanoseconds since 1970");
    }
    ScanEntry& entry = mutable_recording().scans.emplace_back();
    entry.stem = scan.stem;
    entry.file = scan.file;
    entry.stamp_ns = static_cast<std::int64_t>(*stamp_ns);
    entry.points = helipr_point_count(size_of(scan.file), sensor_, *entry.stamp_ns, scan.file);
  }
  if (size() == 0) throw DataError(folder, "holds no scan", "<stamp_ns>.bin");
}

void HeliprSequence::take_poses(const std::filesystem::path& folder, const Reading& asked) {
  if (!asked.has_own_poses()) {
    place_scans(folder, "", asked, mutable_recording());
    return;
  }
  const auto place = parent_folder(folder).parent_path() / "LiDAR_GT";
  take_ground_truth(place / fmt::format("{}_gt.txt", to_string(sensor_)), asked.max_pose_gap_s);
}

void HeliprSequence::take_ground_truth(const std::filesystem::path& file, double max_gap_s) {
  Recording& recording = mutable_recording();
  std::vector<std::pair<std::int64_t, Pose>> stamped;
  for (const HeliprPose& pose : parse_helipr_poses(read_file(file), file)) {
    stamped.emplace_back(pose.stamp_ns, pose.map_from_sensor);
  }
  const PoseTrack track(std::move(stamped));
  SensorPoses own = own_poses("LiDAR_GT/" + file.filename().string(), file);
  own.files = {file};
  for (const ScanEntry& scan : recording.scans) {
    auto pose = track.at(*scan.stamp_ns);
    if (static_cast<double>(track.gap_ns(*scan.stamp_ns)) > max_gap_s * 1e9) pose.reset();
    own.map_from_sensor.push_back(pose);
  }
  const std::size_t scans = size();
  place_scans(std::move(own), recording);
  if (recording.scans.empty()) {
    throw DataError(file, "has a pose of no scan", "stamps of the scans");
  }
  if (!recording.left_out.empty()) {
    recording.remarks.push_back(fmt::format("left out {} of {}: no pose in {}",
                                            recording.left_out.size(), counted(scans, "scan"),
                                            file.filename().string()));
  }
}

void HeliprSequence::read(std::size_t scan_index, Frame& frame) const {
  const ScanEntry& entry = scan(scan_index);
  HeliprScan scan =
      parse_helipr_scan(read_file(*entry.file), sensor_, *entry.stamp_ns, *entry.file);
  check_count(scan_index, scan.points.size());
  describe(scan_index, frame);
  frame.points = std::move(scan.points);
  frame.radial_velocity_m_s = std::move(scan.radial_velocity_m_s);
  if (gives_times_) frame.point_times_ns = std::move(scan.times_ns);
  frame.truth.reset();
}

std::vector<std::uint32_t> HeliprSequence::read_truth(std::size_t scan_index) const {
  refuse_truth(scan_index);
}

}  // namespace mosbench
