#include "datasets/recording.hpp"

#include <fmt/format.h>

#include <limits>

#include "datasets/calib_file.hpp"
#include "datasets/errors.hpp"
#include "datasets/files.hpp"
#include "datasets/pose_file.hpp"
#include "datasets/scan_file.hpp"
#include "datasets/times_file.hpp"

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

Recording::Recording(const std::filesystem::path& folder,
                     const std::optional<std::filesystem::path>& poses_file)
    : scans_(list_scans(folder)) {
  point_counts_.reserve(scans_.size());
  for (const StemFile& scan : scans_) point_counts_.push_back(scan_point_count(scan.file));
  open_poses(folder, poses_file);
  open_stamps(folder);
}

void Recording::open_poses(const std::filesystem::path& folder,
                           const std::optional<std::filesystem::path>& poses_file) {
  const std::filesystem::path file = poses_file.value_or(folder / "poses.txt");
  if (!poses_file && !is_there(file)) {
    throw DataError(file, "does not exist",
                    "one pose per scan there, or in a file given by --poses");
  }
  if (poses_file) remarks_.push_back("poses from " + file.string());
  poses_ = read_poses(file);
  side_files_.push_back(file);
  check_count(poses_.size(), "pose rows", scans_.size(), file);

  const std::filesystem::path calib = folder / "calib.txt";
  if (!is_there(calib)) {
    remarks_.push_back("no calib.txt: the poses are taken as the lidar's");
    return;
  }
  const Pose camera_from_lidar = read_calib(calib);
  side_files_.push_back(calib);
  if (camera_from_lidar.matrix() == Pose::Identity().matrix()) return;
  for (Pose& pose : poses_) pose = lidar_pose(pose, camera_from_lidar);
  remarks_.push_back(fmt::format(
      "calib.txt holds a Tr other than the identity: {} is taken as camera poses, lidar pose = "
      "Tr^-1 * P * Tr (KITTI)",
      file.filename().string()));
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

Frame Recording::read(std::size_t scan_index) const {
  const StemFile& scan = scans_.at(scan_index);
  Frame frame;
  frame.stem = scan.stem;
  frame.points = read_scan(scan.file);
  if (frame.points.size() != point_counts_[scan_index]) {
    throw DataError(scan.file, "changed since the sequence was opened",
                    fmt::format("{} points", point_counts_[scan_index]));
  }
  frame.map_from_sensor = poses_[scan_index];
  if (!stamps_ns_.empty()) frame.stamp_ns = stamps_ns_[scan_index];
  return frame;
}

std::vector<std::filesystem::path> Recording::files() const {
  std::vector<std::filesystem::path> files = side_files_;
  for (const StemFile& scan : scans_) files.push_back(scan.file);
  return files;
}

}  // namespace mosbench
