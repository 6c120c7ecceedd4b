#include "datasets/sequence/folder_sequence.hpp"

#include <fmt/format.h>

#include <utility>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/label_formats.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/sequence/pose_clock.hpp"
#include "datasets/sequence/stamps.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
FolderSequence::FolderSequence(std::string name, const std::filesystem::path& folder,
                               const Reading& asked, const FolderLayout& layout)
    : bin_columns_(asked.bin_columns.value_or(kUsualBinColumns)),
      times_in_column_(asked.undistorts() && asked.takes_column()) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), folder);
  list_scans(folder, layout, !asked.bin_columns);
  read_stamps(folder, recording);
  Reading posed = asked;
  if (layout.poses_of_lidar && asked.has_own_poses() && !asked.pose_frame) {
    posed.pose_frame = PoseFrame::kLidar;
  }
  const std::vector<std::filesystem::path> times = std::exchange(recording.files, {});
  place_scans(folder, std::string(layout.poses_file), posed, recording);
  recording.files.insert(recording.files.end(), times.begin(), times.end());
  judge_times(asked);
  const PoseAt pose_at = stamped_poses(folder, std::string(layout.poses_file), posed);
  if (const auto clocks = doubt_about_clock(*this, pose_at)) add_clock_doubt(recording, *clocks);
}

void FolderSequence::list_scans(const std::filesystem::path& folder, const FolderLayout& layout,
                                bool columns_are_usual) {
  Recording& recording = mutable_recording();
  const bool is_flat = layout.scan_folder == ".";
  std::vector<StemFile> scans =
      layout.scan_folder.empty() ? mosbench::list_scans(folder)
                                 : list_scan_folder(is_flat ? folder : folder / layout.scan_folder);
  if (columns_are_usual) check_usual_bin_columns(scans);
  const std::filesystem::path& first = scans.front().file;
  recording.reading.scan_files =
      fmt::format("{} of {}/", first.extension().string(),
                  is_flat ? "." : first.parent_path().filename().string());
  if (bin_columns_ != kUsualBinColumns) recording.reading.bin_columns = bin_columns_;
  recording.scans.reserve(scans.size());
  for (StemFile& scan : scans) {
    const ScanHead head = read_scan_head(scan.file, bin_columns_);
    labelled_.push_back(head.has_labels);
    times_in_fields_ = times_in_fields_ && head.has_times && scan.file.extension() != ".bin";
    if (times_in_column_ && !head.has_times) {
      throw DataError(
          scan.file, "holds no times of points",
          fmt::format("{} in .pcd and .ply files, {} for .bin files, with {}", kTimeFields,
                      option("bin_columns", "5"), option("point_times", "column")));
    }
    ScanEntry& entry = recording.scans.emplace_back();
    entry.stem = std::move(scan.stem);
    entry.file = std::move(scan.file);
    entry.points = head.points;
  }
}

void FolderSequence::judge_times(const Reading& asked) {
  Recording& recording = mutable_recording();
  if (!asked.undistorts() || recording.scans.empty()) return;
  const bool is_bin = recording.scans.front().file->extension() == ".bin";
  if (!times_in_column_ && (asked.point_times || !times_in_fields_ || is_bin)) return;
  if (!times_in_column_ && !usual_step_s(recording.scans)) {
    recording.remarks.push_back(
        fmt::format("point times: not used, as scans have no stamps; with {} scans are taken to be "
                    "0.1 s apart",
                    option("point_times", "column")));
    return;
  }
  clock_ = judged_clock(
      recording,
      [&](std::size_t k) {
        return read_scan_parts(*scan(k).file, bin_columns_, {.times = true}).times;
      },
      told_unit(asked), !is_bin);
}

std::vector<std::int64_t> FolderSequence::times_ns(std::size_t scan_index,
                                                   std::vector<double> times) const {
  std::vector<std::int64_t> after_ns =
      clock_.after_stamp_ns({std::move(times), stamp_ns(scan_index)});
  settle_times(after_ns, 0);
  return after_ns;
}

void FolderSequence::read(std::size_t scan_index, Frame& frame) const {
  const std::filesystem::path& file = *scan(scan_index).file;
  const WantedParts wanted{.times = reads_times(),
                           .labels = truth_in_scans_ && has_truth(scan_index)};
  ScanParts parts;
  if (wanted.times || wanted.labels) {
    parts = read_scan_parts(file, bin_columns_, wanted);
  } else {
    parts.points = read_points(scan_index, std::move(frame.points));
  }
  frame.points = std::move(parts.points);
  check_count(scan_index, frame.points.size());
  describe(scan_index, frame);
  frame.point_times_ns = times_ns(scan_index, std::move(parts.times));
  if (wanted.labels) {
    frame.truth = std::move(parts.labels);
  } else {
    add_truth(scan_index, frame);
  }
}

std::vector<Point> FolderSequence::read_points(std::size_t scan_index,
                                               std::vector<Point> reused) const {
  return read_scan(*scan(scan_index).file, bin_columns_, std::move(reused));
}

std::size_t FolderSequence::take_labels_of_scans() {
  truth_in_scans_ = true;
  std::size_t labelled = 0;
  for (ScanEntry& entry : mutable_recording().scans) {
    entry.has_truth = labelled_[*entry.number];  // scans without a pose were left out meanwhile
    labelled += entry.has_truth ? 1 : 0;
  }
  return labelled;
}

std::vector<std::uint32_t> FolderSequence::read_truth(std::size_t scan_index) const {
  if (!truth_in_scans_ || !has_truth(scan_index)) refuse_truth(scan_index);
  return read_cloud_labels(*scan(scan_index).file);
}

}  // namespace mosbench
