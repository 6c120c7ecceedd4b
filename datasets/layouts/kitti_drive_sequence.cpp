#include "datasets/layouts/kitti_drive_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "datasets/formats/point_range.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/hdf5/flow_truth.hpp"
#include "datasets/layouts/points_in_boxes.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

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

}  // namespace

KittiDriveSequence::KittiDriveSequence(KittiDrive drive, const Reading& asked)
    : bin_columns_(asked.bin_columns.value_or(kBinColumns)),
      view_(drive.view),
      unlabelled_(std::move(drive.unlabelled)) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(drive.name, drive.folder);
  recording.files = drive.files;
  recording.truth_files = drive.truth_files;
  recording.remarks = drive.remarks;
  const double moving_speed_m_s = asked.moving_speed_m_s.value_or(kFlowMovingSpeed_m_s);
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

void KittiDriveSequence::list_scans(const KittiDrive& drive) {
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
        "{}, of {}", counted(frames - size(), "frame has no scan", "frames have no scan"), frames));
  }
}

void KittiDriveSequence::take_oxts(const KittiDrive& drive) {
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
    recording.remarks.push_back(counted(recording.left_out.size(),
                                        "scan has no packet in oxts and is left out",
                                        "scans have no packet in oxts and are left out"));
  }
}

void KittiDriveSequence::take_poses(const KittiDrive& drive, const Reading& asked) {
  if (asked.has_own_poses()) return take_oxts(drive);
  place_scans(drive.folder, "", asked, mutable_recording());
}

std::vector<std::uint32_t> KittiDriveSequence::truth_of(std::size_t frame,
                                                        std::span<const Point> points) const {
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

void KittiDriveSequence::read(std::size_t scan_index, Frame& frame) const {
  const ScanEntry& entry = scan(scan_index);
  frame.points = read_scan(*entry.file, bin_columns_, std::move(frame.points));
  check_count(scan_index, frame.points.size());
  describe(scan_index, frame);
  frame.truth.reset();
  if (entry.has_truth) frame.truth = truth_of(frame_of(entry), frame.points);
}

std::vector<std::uint32_t> KittiDriveSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  Frame frame;
  read(scan_index, frame);
  return std::move(*frame.truth);
}

}  // namespace mosbench
