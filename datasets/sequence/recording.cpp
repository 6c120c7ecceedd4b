#include "datasets/sequence/recording.hpp"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/scan_file.hpp"
#include "datasets/files/times_file.hpp"
#include "datasets/sequence/pose_source.hpp"

namespace mosbench {
namespace {

/// A stem of this value or above is a time in nanoseconds (11 days and more), not a scan's number.
constexpr std::uint64_t kSmallestStampStem = 1'000'000'000'000'000;

void check_count(std::size_t rows, const char* what, std::size_t scans,
                 const std::filesystem::path& file) {
  if (rows == scans) return;
  throw DataError(file, fmt::format("{} {} for {} scans", rows, what, scans), "one per scan");
}

std::vector<std::int64_t> stamps_from_stems(const std::vector<StemFile>& scans) {
  std::vector<std::int64_t> stamps_ns;
  for (const StemFile& scan : scans) {
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

Recording::Recording(const std::filesystem::path& folder, const ReadingOptions& told,
                     const RecordingPlaces& places)
    : scans_(places.scan_folder.empty() ? list_scans(folder)
                                        : list_scan_folder(folder / places.scan_folder)),
      bin_columns_(told.bin_columns) {
  ReadingOptions options = told;
  if (places.poses_of_lidar && !options.poses && options.pose_frame == PoseFrame::kByCalib) {
    options.pose_frame = PoseFrame::kLidar;
  }
  point_counts_.reserve(scans_.size());
  for (const StemFile& scan : scans_)
    point_counts_.push_back(scan_point_count(scan.file, bin_columns_));
  open_stamps(folder);
  SettledPoses settled = settle_poses(folder, places.poses_file, options, {size(), stamps_ns_});
  poses_ = std::move(settled.map_from_sensor);
  side_files_.insert(side_files_.begin(), settled.files.begin(), settled.files.end());
  remarks_ = std::move(settled.remarks);
  reading_ = {{"scan_files", fmt::format("{} of {}/", scans_.front().file.extension().string(),
                                         scans_.front().file.parent_path().filename().string())}};
  if (bin_columns_ != ReadingOptions{}.bin_columns) {
    reading_.emplace_back("bin_columns", std::to_string(bin_columns_));
  }
  reading_.insert(reading_.end(), settled.reading.begin(), settled.reading.end());
}

void Recording::open_stamps(const std::filesystem::path& folder) {
  const std::filesystem::path times = folder / "times.txt";
  if (!is_there(times)) {
    stamps_ns_ = stamps_from_stems(scans_);
    return;
  }
  stamps_ns_ = read_times(times);
  side_files_.push_back(times);
  check_count(stamps_ns_.size(), "times", scans_.size(), times);
}

Frame Recording::read_frame(std::size_t scan_index, Frame spent) const {
  const StemFile& scan = scans_.at(scan_index);
  Frame frame;
  frame.stem = scan.stem;
  frame.points = read_scan(scan.file, bin_columns_, std::move(spent.points));
  if (frame.points.size() != point_counts_[scan_index]) {
    throw DataError(scan.file, "changed since the sequence was opened",
                    fmt::format("{} points", point_counts_[scan_index]));
  }
  frame.map_from_sensor = poses_[scan_index];
  frame.stamp_ns = stamp_ns(scan_index);
  return frame;
}

std::vector<std::filesystem::path> Recording::files() const {
  std::vector<std::filesystem::path> files = side_files_;
  for (const StemFile& scan : scans_) files.push_back(scan.file);
  return files;
}

}  // namespace mosbench
