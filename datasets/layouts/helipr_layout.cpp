#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/disk/partial_file.hpp"
#include "datasets/formats/helipr_points.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

HeliprSensor sensor_of_folder(const fs::path& folder) {
  const auto sensor = helipr_sensor_from_string(folder_name(folder));
  if (!sensor) throw DataError(folder, "is no LiDAR of HeLiPR", "Aeva, Avia, Ouster or Velodyne");
  return *sensor;
}

/// One LiDAR of a recording of HeLiPR as it is published: LiDAR/<sensor>/<stamp_ns>.bin with packed
/// points, poses in LiDAR_GT/<sensor>_gt.txt. It has no truth; HeLiMOS labels part of KAIST05.
class HeliprSequence : public Sequence {
 public:
  /// `folder` is LiDAR/<sensor>. Throws DataError.
  HeliprSequence(std::string name, const fs::path& folder, const Reading& asked)
      : sensor_(sensor_of_folder(folder)),
        gives_times_(asked.undistorts() && asked.takes_column()) {
    Recording& recording = mutable_recording();
    recording.name = SequenceName(std::move(name), folder);
    recording.reading.scan_files = fmt::format(".bin of {}, packed", to_string(sensor_));
    recording.has_radial_velocities = sensor_ == HeliprSensor::kAeva;
    if (gives_times_) recording.reading.point_times = "of each point";
    recording.remarks = {"no truth: HeLiMOS labels part of KAIST05"};
    list_scans(folder);
    take_poses(folder, asked);
  }

  using Sequence::read;

  void read(std::size_t scan_index, Frame& frame) const override {
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

 private:
  void list_scans(const fs::path& folder) {
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

  void take_ground_truth(const fs::path& file, const Reading& asked) {
    Recording& recording = mutable_recording();
    std::vector<std::pair<std::int64_t, Pose>> stamped;
    for (const HeliprPose& pose : parse_helipr_poses(read_file(file), file)) {
      stamped.emplace_back(asked.moved_ns(pose.stamp_ns), pose.map_from_sensor);
    }
    const PoseTrack track(std::move(stamped));
    SensorPoses own = own_poses("LiDAR_GT/" + file.filename().string(), file);
    own.files = {file};
    own.done.offset_s = asked.pose_offset_s;
    for (const ScanEntry& scan : recording.scans) {
      auto pose = track.at(*scan.stamp_ns);
      if (static_cast<double>(track.gap_ns(*scan.stamp_ns)) > asked.max_pose_gap_s * 1e9) {
        pose.reset();
      }
      own.map_from_sensor.push_back(pose);
    }
    const std::size_t scans = size();
    place_scans(std::move(own), recording);
    if (recording.scans.empty()) {
      throw DataError(file, "has a pose of no scan", "stamps of the scans");
    }
    if (!recording.left_out.empty()) {
      recording.doubts.push_back(fmt::format("left out {} of {}: no pose in {}",
                                             recording.left_out.size(), counted(scans, "scan"),
                                             file.filename().string()));
    }
  }

  void take_poses(const fs::path& folder, const Reading& asked) {
    if (!asked.has_own_poses()) {
      place_scans(folder, "", asked, mutable_recording());
      return;
    }
    const auto place = parent_folder(folder).parent_path() / "LiDAR_GT";
    take_ground_truth(place / fmt::format("{}_gt.txt", to_string(sensor_)), asked);
  }

  HeliprSensor sensor_;
  bool gives_times_;
};

HeliprSensor sensor_of(bool radial_velocities) {
  return radial_velocities ? HeliprSensor::kAeva : HeliprSensor::kOuster;
}

fs::path scan_file(HeliprSensor sensor, std::int64_t stamp_ns) {
  return fs::path("LiDAR") / to_string(sensor) / fmt::format("{}.bin", stamp_ns);
}

const char* helipr_last_file(const WriteOptions& options) {
  return options.radial_velocities ? "LiDAR_GT/Aeva_gt.txt" : "LiDAR_GT/Ouster_gt.txt";
}

class HeliprWriter : public SequenceWriter {
 public:
  HeliprWriter(fs::path folder, const WriteOptions& options)
      : folder_(std::move(folder)),
        sensor_(sensor_of(options.radial_velocities)),
        last_file_(helipr_last_file(options)),
        poses_(options.scans) {}

  void write(std::size_t scan_index, const Frame& frame) override {
    const std::int64_t stamp_ns = stamp_or_period_ns(scan_index, frame.stamp_ns);
    if (stamp_ns < 0) {
      throw DataError(folder_, "scan " + frame.stem + " has a stamp below 0", "ns since 1970");
    }
    poses_[scan_index] = {stamp_ns, frame.map_from_sensor};
    write_file_atomic(folder_ / scan_file(sensor_, stamp_ns), packed(frame, stamp_ns));
  }

  void finish() override {
    for (std::size_t k = 1; k < poses_.size(); ++k) {
      if (poses_[k].stamp_ns > poses_[k - 1].stamp_ns) continue;
      throw DataError(folder_,
                      fmt::format("two scans or more up to {} have stamps that do not "
                                  "increase",
                                  poses_[k].stamp_ns),
                      "one after the other, as HeLiPR names scans by them");
    }
    sync_file_system_of(folder_);
    commit_file(folder_ / last_file_, format_helipr_poses(poses_));
  }

 private:
  std::string packed(const Frame& frame, std::int64_t stamp_ns) const {
    if (sensor_ != HeliprSensor::kAeva) return format_helipr_ouster(frame.points);
    if (frame.radial_velocity_m_s.size() != frame.points.size()) {
      throw DataError(folder_,
                      fmt::format("scan {} has {} radial velocities", frame.stem,
                                  frame.radial_velocity_m_s.size()),
                      fmt::format("one for each of its {} points", frame.points.size()));
    }
    return format_helipr_aeva(frame.points, frame.radial_velocity_m_s, stamp_ns);
  }

  fs::path folder_;
  HeliprSensor sensor_;
  const char* last_file_;
  std::vector<HeliprPose> poses_;
};

std::vector<fs::path> files_of_helipr(const Sequence& sequence) {
  const HeliprSensor sensor = sensor_of(sequence.recording().has_radial_velocities);
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < sequence.size(); ++k) {
    files.push_back(scan_file(sensor, stamp_or_period_ns(k, sequence.stamp_ns(k))));
  }
  return files;
}

std::unique_ptr<SequenceWriter> write_as_helipr(const fs::path& folder,
                                                const WriteOptions& options) {
  return std::make_unique<HeliprWriter>(folder, options);
}

bool is_helipr_lidar(const fs::path& folder) {
  return helipr_sensor_from_string(folder_name(folder)) &&
         folder_name(parent_folder(folder)) == "LiDAR" && !list_by_stem(folder, {".bin"}).empty();
}

/// Whether a recording is called after its LiDAR, as `convert` calls it: "Roundabout01_Aeva".
bool is_called_after(const fs::path& recording, const fs::path& lidar) {
  return folder_name(recording).ends_with("_" + folder_name(lidar));
}

/// Lists the LiDARs of one recording, each called `prefix` and its own name.
std::vector<SequenceFolder> lidars_of(const fs::path& recording, const std::string& prefix) {
  std::vector<SequenceFolder> sequences;
  for (const fs::path& folder : list_folders(recording / "LiDAR")) {
    if (!is_helipr_lidar(folder)) continue;
    sequences.push_back({prefix + folder_name(folder), folder, ""});
  }
  return sequences;
}

std::vector<SequenceFolder> list_helipr(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return {};
  if (is_helipr_lidar(path)) return {{folder_name(path), path, ""}};
  if (auto sequences = lidars_of(path, ""); !sequences.empty()) return sequences;
  std::vector<SequenceFolder> sequences;
  for (const fs::path& recording : list_folders(path)) {
    auto lidars = lidars_of(recording, folder_name(recording) + "/");
    if (lidars.size() == 1 && is_called_after(recording, lidars.front().folder)) {
      lidars.front().name = folder_name(recording);
    }
    sequences.insert(sequences.end(), lidars.begin(), lidars.end());
  }
  return sequences;
}

std::unique_ptr<Sequence> open_helipr(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<HeliprSequence>(sequence.name, sequence.folder, asked);
}

std::optional<std::string> recognise_helipr(const fs::path& path) {
  const auto sequences = list_helipr(path);
  if (sequences.empty()) return std::nullopt;
  return "packed scans of HeLiPR's " + folder_name(sequences.front().folder) + " are there";
}

}  // namespace

const Layout& helipr_layout() {
  static const Layout row = {
      .name = "helipr",
      .usual = {"helipr", "semantickitti-mos"},
      .title = "HeLiPR, IJRR 2024, as recorded",
      .content = "Aeva, Livox Avia, Ouster OS2-128 and Velodyne VLP-16 on one car",
      .size = "see its page",
      .published = "sites.google.com/view/heliprdataset",
      .licence = "CC BY-NC-SA 4.0",
      .folders = {"<root>/<recording>/", "  LiDAR/{Aeva,Avia,Ouster,Velodyne}/<stamp_ns>.bin",
                  "  LiDAR_GT/<sensor>_gt.txt       stamp_ns x y z qx qy qz qw",
                  "no labels: HeLiMOS has those of KAIST05"},
      .files = {.sensor_range_m = 450.0},
      .expected =
          "LiDAR/{Aeva,Avia,Ouster,Velodyne}/<stamp_ns>.bin and LiDAR_GT/ (HeLiPR), a folder of "
          "such "
          "recordings, or one such folder of scans",
      .list = list_helipr,
      .open = open_helipr,
      .evidence = Evidence::kFolders,
      .recognise = recognise_helipr,
      .scan_folders = 2,
      .writer = LayoutWriter{.open = write_as_helipr,
                             .folder = flat_folder,
                             .files = files_of_helipr,
                             .last_file = helipr_last_file,
                             .keeps = KeptTruth::kNone,
                             .keeps_radial_velocities = true},
      .simulation = LayoutSimulation{
          .recordings = {{"{}", "{}/Aeva", SensorKind::kAeva},
                         {"{}", "{}/Ouster", SensorKind::kOs2_128}},
          .truth = "There is no truth: HeLiPR has no place for it.",
          .is_global = true,
          .stem = [](std::size_t, std::int64_t stamp_ns) { return std::to_string(stamp_ns); }}};
  return row;
}

}  // namespace mosbench
