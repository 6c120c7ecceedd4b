#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/boxes.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_drive.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBinColumns = 4;

std::size_t frame_of(const ScanEntry& scan) {
  return static_cast<std::size_t>(stem_number(scan.stem).value());
}

/// Whether oxts place a frame, without which nothing is known of its boxes' speeds.
bool is_placed(const KittiDrive& drive, std::size_t frame) {
  return frame < drive.frames.size() && drive.frames[frame];
}

[[noreturn]] void refuse_speed(const KittiDrive& drive) {
  throw UsageError(
      fmt::format("{}: the boxes of {} in {} were made of labels by mosbench and have no speeds, "
                  "expected no such flag, or KITTI's own drive",
                  option("moving_speed_m_s"), drive.name, drive.folder.string()));
}

bool holds(const ImageRegion& region, const Eigen::Vector3d& projected) {
  const double x_px = projected.x() / projected.z(), y_px = projected.y() / projected.z();
  return x_px >= region[0] && x_px <= region[2] && y_px >= region[1] && y_px <= region[3];
}

/// A drive of KITTI's raw data or of its tracking benchmark. Truth, where there is any: 251 in
/// boxes that move, 9 elsewhere in the view of camera 2, 0 beyond it, in regions that nobody
/// labelled, and in boxes that are seen once; in the upper 16 bits the object of a box. Frames
/// that are within such a box as a whole have none.
class KittiDriveSequence : public Sequence {
 public:
  /// Throws DataError; MissingPoses for a drive without oxts or calibration.
  KittiDriveSequence(KittiDrive drive, const Reading& asked)
      : bin_columns_(asked.bin_columns.value_or(kBinColumns)),
        view_(drive.view),
        unlabelled_(std::move(drive.unlabelled)) {
    Recording& recording = mutable_recording();
    recording.name = SequenceName(drive.name, drive.folder);
    recording.files = drive.files;
    recording.truth_files = drive.truth_files;
    recording.remarks = drive.remarks;
    const double moving_speed_m_s = asked.moving_speed_m_s.value_or(kBoxMovingSpeed_m_s);
    recording.reading.scan_files = ".bin of the drive";
    if (drive.has_truth) {
      const bool of_labels = is_of_labels(drive.tracks);
      if (of_labels && asked.moving_speed_m_s) refuse_speed(drive);
      recording.reading.truth = fmt::format(
          "boxes of {}, {}, in the view of camera 2", drive.truth_source,
          of_labels ? "made of labels" : fmt::format("moving from {:g} m/s on", moving_speed_m_s));
      boxes_ = label_boxes(drive.tracks, drive.frames, moving_speed_m_s);
    }
    list_scans(drive);
    take_poses(drive, asked);
  }

  using Sequence::read;

  void read(std::size_t scan_index, Frame& frame) const override {
    const ScanEntry& entry = scan(scan_index);
    frame.points = read_scan(*entry.file, bin_columns_, std::move(frame.points));
    check_count(scan_index, frame.points.size());
    describe(scan_index, frame);
    frame.truth.reset();
    if (entry.has_truth) frame.truth = truth_of(frame_of(entry), frame.points);
  }

 private:
  void list_scans(const KittiDrive& drive) {
    for (const StemFile& scan : drive.scans) {
      ScanEntry& entry = mutable_recording().scans.emplace_back();
      entry.stem = scan.stem;
      entry.file = scan.file;
      entry.points = read_scan_head(scan.file, bin_columns_).points;
      const std::size_t frame = frame_of(entry);
      entry.has_truth = is_placed(drive, frame) && drive.has_truth && !is_unlabelled(boxes_[frame]);
      if (!drive.stamps_ns.empty()) entry.stamp_ns = drive.stamps_ns[frame_of(entry)];
    }
    const std::size_t frames = frame_of(mutable_recording().scans.back()) + 1;
    if (frames > size()) {
      mutable_recording().remarks.push_back(fmt::format(
          "{}, of {}", counted(frames - size(), "frame has no scan", "frames have no scan"),
          frames));
    }
  }

  void take_oxts(const KittiDrive& drive) {
    Recording& recording = mutable_recording();
    if (!drive.missing.empty()) {
      throw MissingPoses(drive.missing, "is not there",
                         "oxts and calibration, which give KITTI's drives their poses, or poses of "
                         "another source");
    }
    SensorPoses own = own_poses(drive.pose_source, drive.pose_file);
    for (const ScanEntry& scan : recording.scans) {
      const std::size_t frame = frame_of(scan);
      own.map_from_sensor.push_back(is_placed(drive, frame)
                                        ? std::optional(drive.frames[frame]->map_from_lidar)
                                        : std::nullopt);
    }
    place_scans(std::move(own), recording);
    if (recording.scans.empty()) {
      throw DataError(drive.pose_file, "belongs to no scan", "packets of the frames of the scans");
    }
    if (!recording.left_out.empty()) {
      recording.doubts.push_back(counted(recording.left_out.size(),
                                         "scan has no packet in oxts and is left out",
                                         "scans have no packet in oxts and are left out"));
    }
  }

  void take_poses(const KittiDrive& drive, const Reading& asked) {
    if (asked.has_own_poses()) return take_oxts(drive);
    place_scans(drive.folder, "", asked, mutable_recording());
  }

  std::vector<std::uint32_t> truth_of(std::size_t frame, std::span<const Point> points) const {
    std::vector<std::uint32_t> truth(points.size(), kStaticLabel);
    const auto regions = unlabelled_.find(frame);
    if (regions != unlabelled_.end()) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d at = view_.project(position_of(points[i]));
        if (std::ranges::any_of(regions->second, [&](const auto& r) { return holds(r, at); })) {
          truth[i] = 0;
        }
      }
    }
    if (frame < boxes_.size() && !boxes_[frame].empty()) {
      const PointsInBoxes search(points);
      for (const LabelledBox& box : boxes_[frame]) {
        search.label(box.box_from_lidar, box.half_size_m, box.label, truth);
      }
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!view_.sees(position_of(points[i]))) truth[i] = 0;
    }
    return truth;
  }

  std::size_t bin_columns_;
  CameraView view_;
  std::vector<std::vector<LabelledBox>> boxes_;  ///< by frame
  std::map<std::size_t, std::vector<ImageRegion>> unlabelled_;
};

bool is_drive(const fs::path& folder) { return is_there(folder / "velodyne_points" / "data"); }

/// "2011_09_26_drive_0001" of "2011_09_26_drive_0001_sync".
std::string drive_alias(const std::string& name) {
  constexpr std::string_view kEnd = "_sync";
  return name.ends_with(kEnd) ? name.substr(0, name.size() - kEnd.size()) : name;
}

/// Leaves out unsynchronized drives, whose scans are text and which may lie beside the others.
std::vector<SequenceFolder> drives_in(const fs::path& date) {
  std::vector<SequenceFolder> drives;
  for (const fs::path& folder : list_folders(date)) {
    const std::string name = folder_name(folder);
    if (is_drive(folder) && !name.ends_with("_extract"))
      drives.push_back({name, folder, drive_alias(name)});
  }
  return drives;
}

std::vector<SequenceFolder> list_kitti_raw(const fs::path& path) {
  if (is_drive(path)) return {{folder_name(path), path, drive_alias(folder_name(path))}};
  if (auto drives = drives_in(path); !drives.empty()) return drives;
  std::vector<SequenceFolder> drives;
  for (const fs::path& date : list_folders(path)) {
    for (SequenceFolder& drive : drives_in(date)) drives.push_back(std::move(drive));
  }
  return drives;
}

std::unique_ptr<Sequence> open_kitti_raw(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<KittiDriveSequence>(read_raw_drive(sequence.name, sequence.folder),
                                              asked);
}

std::optional<std::string> recognise_kitti_raw(const fs::path& path) {
  const auto drives = list_kitti_raw(path);
  if (drives.empty()) return std::nullopt;
  return fmt::format("{} has velodyne_points/data", drives.front().name);
}

fs::path kitti_raw_folder(const std::string& name, std::size_t) {
  return fs::path("date") / flat_name(name);
}

bool is_sequence(const fs::path& folder) {
  return stem_number(folder_name(folder)) && !list_by_stem(folder, {".bin"}).empty();
}

/// Lists velodyne/NNNN of training/ or testing/.
std::vector<SequenceFolder> sequences_in(const fs::path& part, const std::string& prefix) {
  std::vector<SequenceFolder> sequences;
  for (const fs::path& folder : list_folders(part / "velodyne")) {
    const std::string number = folder_name(folder);
    if (is_sequence(folder)) {
      sequences.push_back({prefix + number, folder, prefix.empty() ? "" : number});
    }
  }
  return sequences;
}

/// Whether a folder is velodyne/, beside which one of the other folders lies.
bool is_of_benchmark(const fs::path& velodyne) {
  const fs::path part = parent_folder(velodyne);
  return folder_name(velodyne) == "velodyne" &&
         (is_there(part / "oxts") || is_there(part / "calib") || is_there(part / "label_02"));
}

/// Those of a root: training/ has labels, testing/ is read where it is given itself.
std::vector<SequenceFolder> sequences_of(const fs::path& root, const std::string& prefix) {
  auto sequences = sequences_in(root / "training", prefix);
  return sequences.empty() ? sequences_in(root, prefix) : sequences;
}

std::vector<SequenceFolder> list_kitti_tracking(const fs::path& path) {
  if (is_of_benchmark(path)) return sequences_in(parent_folder(path), "");
  if (is_of_benchmark(parent_folder(path)) && is_sequence(path)) {
    return {{folder_name(path), path, ""}};
  }
  auto sequences = sequences_of(path, "");
  if (!sequences.empty()) return sequences;
  for (const fs::path& root : list_folders(path)) {
    for (SequenceFolder& sequence : sequences_in(root / "training", folder_name(root) + "/")) {
      sequences.push_back(std::move(sequence));
    }
  }
  return sequences;
}

std::unique_ptr<Sequence> open_kitti_tracking(const SequenceFolder& sequence,
                                              const Reading& asked) {
  return std::make_unique<KittiDriveSequence>(read_tracking_drive(sequence.name, sequence.folder),
                                              asked);
}

/// Scans alone may lie in such folders elsewhere, too, and one given itself with poses of its own.
std::optional<std::string> recognise_kitti_tracking(const fs::path& path) {
  const auto sequences = list_kitti_tracking(path);
  if (sequences.empty()) return std::nullopt;
  const fs::path& first = sequences.front().folder;
  const bool has_own_poses = first == path && is_there(path / "poses.txt");
  if (has_own_poses || !is_of_benchmark(parent_folder(first))) return std::nullopt;
  return "scans are in velodyne/" + folder_name(sequences.front().folder);
}

std::optional<std::string> recognise_part_of_kitti_tracking(const fs::path& path) {
  const auto sequences = list_kitti_tracking(path);
  if (sequences.empty()) return std::nullopt;
  return "scans are in velodyne/" + folder_name(sequences.front().folder);
}

/// 9, 251 with the owner as instance or, without a label
/// and all beyond the camera's view, 0.
std::uint32_t kitti_label_in_view(const SimulatedReturn& seen) {
  static const CameraView kView = written_kitti_mounting().view;
  if (!kView.sees(position_of(seen.point))) return 0;
  const std::uint32_t label = moving_label(seen);
  return label == kMovingLabel ? with_instance(label, seen.owner_number) : label;
}

}  // namespace

const Layout& kitti_raw_layout() {
  static const Layout row = {
      .name = "kitti-raw",
      .usual = {"kitti-raw", "semantickitti-mos"},
      .title = "KITTI raw data, IJRR 2013, with truth made of its tracklets",
      .content = "Velodyne HDL-64E on a car, 10 Hz, boxes of objects in the camera's view",
      .size = "see its page",
      .published = "cvlibs.net/datasets/kitti/raw_data.php",
      .licence = "CC BY-NC-SA 3.0",
      .folders = {"<root>/<date>/                      2011_09_26 and so on",
                  "  calib_{imu_to_velo,velo_to_cam,cam_to_cam}.txt",
                  "  <date>_drive_<number>_sync/", "    velodyne_points/data/*.bin, timestamps.txt",
                  "    oxts/data/*.txt, timestamps.txt",
                  "    tracklet_labels.xml             for truth"},
      .files = {.label_ids = {0, kStaticLabel, kMovingLabel}, .sensor_range_m = 130.0},
      .expected =
          "<date>/<drive>/velodyne_points/data/*.bin of KITTI's raw data, a date or one drive",
      .list = list_kitti_raw,
      .open = open_kitti_raw,
      .no_point_times = [](const std::filesystem::path&) -> std::string {
        return "the points of KITTI's drives have no times, expected azimuth or none";
      },
      .evidence = Evidence::kFolders,
      .recognise = recognise_kitti_raw,
      .scan_folders = 2,
      .writer = LayoutWriter{.open = write_as_kitti_raw,
                             .folder = kitti_raw_folder,
                             .files = files_of_kitti_raw,
                             .last_file = [](const WriteOptions&) { return kKittiRawLastFile; },
                             .keeps = KeptTruth::kInView},
      .truth_by_speed = true,
      .simulation = LayoutSimulation{
          .recordings = {{"date/{}", "{}", SensorKind::kHdl64e}},
          .label = kitti_label_in_view,
          .stem = [](std::size_t k, std::int64_t) { return fmt::format("{:010}", k); }}};
  return row;
}

const Layout& kitti_tracking_layout() {
  static const Layout row = {
      .name = "kitti-tracking",
      .usual = {"kitti-tracking", "semantickitti-mos"},
      .title = "KITTI tracking, CVPR 2012, with truth made of its boxes",
      .content = "Velodyne HDL-64E on a car, 10 Hz, boxes of objects in the camera's view",
      .size = "21 sequences with labels, 29 without",
      .published = "cvlibs.net/datasets/kitti/eval_tracking.php",
      .licence = "CC BY-NC-SA 3.0",
      .folders = {"<root>/training/", "  velodyne/<number>/*.bin", "  oxts/<number>.txt",
                  "  calib/<number>.txt", "  label_02/<number>.txt    for truth",
                  "<root>/<folder>/           such roots, as convert writes them"},
      .files = {.label_ids = {0, kStaticLabel, kMovingLabel}, .sensor_range_m = 130.0},
      .expected =
          "training/{velodyne/<number>/*.bin,oxts,calib,label_02} of KITTI's tracking benchmark",
      .list = list_kitti_tracking,
      .open = open_kitti_tracking,
      .no_point_times = [](const std::filesystem::path&) -> std::string {
        return "the points of KITTI's drives have no times, expected azimuth or none";
      },
      .evidence = Evidence::kFolders,
      .recognise = recognise_kitti_tracking,
      .recognise_part = recognise_part_of_kitti_tracking,
      .scan_folders = 3,
      .writer =
          LayoutWriter{.open = write_as_kitti_tracking,
                       .folder = flat_folder,
                       .files = files_of_kitti_tracking,
                       .last_file = [](const WriteOptions&) { return kKittiTrackingLastFile; },
                       .keeps = KeptTruth::kInView,
                       .keeps_stamps = false},
      .truth_by_speed = true,
      .simulation = LayoutSimulation{.recordings = {{"{}", "{}/0000", SensorKind::kHdl64e}},
                                     .label = kitti_label_in_view,
                                     .stamp_ns = no_stamp}};
  return row;
}

}  // namespace mosbench
