#include "datasets/sequence/folder_sequence.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/formats/times_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

/// A stem of this value or above is a time in nanoseconds (11 days and more), not a scan's number.
constexpr std::uint64_t kSmallestStampStem = 1'000'000'000'000'000;

std::vector<std::int64_t> stamps_from_stems(const std::vector<ScanEntry>& scans) {
  std::vector<std::int64_t> stamps_ns;
  for (const ScanEntry& scan : scans) {
    const auto number = stem_number(scan.stem);
    if (!number || *number < kSmallestStampStem ||
        *number > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return {};
    }
    stamps_ns.push_back(static_cast<std::int64_t>(*number));
  }
  return stamps_ns;
}

}  // namespace

FolderSequence::FolderSequence(std::string name, const std::filesystem::path& folder,
                               const Reading& asked, const FolderLayout& layout)
    : bin_columns_(asked.bin_columns.value_or(kUsualBinColumns)),
      times_in_column_(asked.undistorts() && asked.point_times == PointTimes::kColumn) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), folder);
  list_scans(folder, layout, !asked.bin_columns);
  const std::vector<std::int64_t> stamps_ns = read_stamps(folder);
  for (std::size_t k = 0; k < stamps_ns.size(); ++k) recording.scans[k].stamp_ns = stamps_ns[k];
  Reading posed = asked;
  if (layout.poses_of_lidar && asked.has_own_poses() && !asked.pose_frame) {
    posed.pose_frame = PoseFrame::kLidar;
  }
  const std::vector<std::filesystem::path> times = std::exchange(recording.files, {});
  place_scans(folder, std::string(layout.poses_file), posed, recording);
  recording.files.insert(recording.files.end(), times.begin(), times.end());
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
  if (times_in_column_) {
    recording.reading.point_times = first.extension() == ".bin" ? "fifth column" : "field of times";
  }
  recording.scans.reserve(scans.size());
  for (StemFile& scan : scans) {
    const ScanHead head = read_scan_head(scan.file, bin_columns_);
    labels_in_scans_ = labels_in_scans_ && head.has_labels;
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

/// Returns one stamp per scan, or none.
std::vector<std::int64_t> FolderSequence::read_stamps(const std::filesystem::path& folder) {
  const std::filesystem::path times = folder / "times.txt";
  if (!is_there(times)) return stamps_from_stems(recording().scans);
  std::vector<std::int64_t> stamps_ns = read_times(times);
  if (stamps_ns.size() != size()) {
    throw DataError(times, fmt::format("{} times for {} scans", stamps_ns.size(), size()),
                    "one per scan");
  }
  mutable_recording().files.push_back(times);
  return stamps_ns;
}

void FolderSequence::read(std::size_t scan_index, Frame& frame) const {
  const std::filesystem::path& file = *scan(scan_index).file;
  TimedScan timed;
  if (times_in_column_) {
    timed = read_timed_scan(file, bin_columns_, stamp_ns(scan_index));
  } else {
    timed.points = read_scan(file, bin_columns_, std::move(frame.points));
  }
  frame.points = std::move(timed.points);
  check_count(scan_index, frame.points.size());
  describe(scan_index, frame);
  frame.point_times_ns = std::move(timed.times_ns);
  add_truth(scan_index, frame);
}

std::vector<std::uint32_t> FolderSequence::read_truth(std::size_t scan_index) const {
  refuse_truth(scan_index);
}

}  // namespace mosbench
