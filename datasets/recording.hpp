#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/folder_listing.hpp"
#include "datasets/sequence.hpp"

namespace mosbench {

/// What all layouts share, everything but truth: the scans of one sequence folder with their poses
/// and, where told, stamps. Opening checks scan sizes and all counts.
class Recording {
 public:
  /// Poses come from `poses_file`, else from poses.txt; either is turned into lidar poses by
  /// calib.txt. Throws DataError.
  Recording(const std::filesystem::path& folder,
            const std::optional<std::filesystem::path>& poses_file);

  std::size_t size() const { return scans_.size(); }
  const StemFile& scan(std::size_t scan_index) const { return scans_.at(scan_index); }
  std::size_t point_count(std::size_t scan_index) const { return point_counts_.at(scan_index); }
  /// From times.txt, else from stems that are nanoseconds; one per scan, or empty.
  const std::vector<std::int64_t>& stamps_ns() const { return stamps_ns_; }
  /// The frame without truth.
  Frame read(std::size_t scan_index) const;
  /// Scans, poses, calibration and times.
  std::vector<std::filesystem::path> files() const;
  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  void open_poses(const std::filesystem::path& folder,
                  const std::optional<std::filesystem::path>& poses_file);
  void open_stamps(const std::filesystem::path& folder);

  std::vector<StemFile> scans_;
  std::vector<std::size_t> point_counts_;
  std::vector<Pose> poses_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::filesystem::path> side_files_;
  std::vector<std::string> remarks_;
};

}  // namespace mosbench
