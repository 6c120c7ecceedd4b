#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/files/folder_listing.hpp"
#include "datasets/sequence/scan_source.hpp"

namespace mosbench {

/// Where a layout keeps the scans and the poses of a sequence.
struct RecordingPlaces {
  std::filesystem::path scan_folder;  ///< within the sequence folder; found by name when empty
  std::string poses_file = "poses.txt";
  bool poses_of_lidar = false;  ///< calib.txt is not applied to poses_file
};

/// A sequence folder with one file per scan, poses in a text file and, where told, stamps. Opening
/// checks scan sizes and all counts.
class Recording : public ScanSource {
 public:
  /// Poses are settled as `settle_poses` tells. Throws DataError.
  Recording(const std::filesystem::path& folder, const ReadingOptions& options,
            const RecordingPlaces& places = {});

  std::size_t size() const override { return scans_.size(); }
  std::string stem(std::size_t scan_index) const override { return scans_.at(scan_index).stem; }
  std::filesystem::path file(std::size_t scan_index) const override {
    return scans_.at(scan_index).file;
  }
  bool has_own_files() const override { return true; }
  std::size_t point_count(std::size_t scan_index) const override {
    return point_counts_.at(scan_index);
  }
  /// From times.txt, else from stems that are nanoseconds.
  const std::vector<std::int64_t>& stamps_ns() const override { return stamps_ns_; }
  Pose map_from_sensor(std::size_t scan_index) const override { return poses_.at(scan_index); }
  /// Scans, poses, calibration and times.
  std::vector<std::filesystem::path> files() const override;
  std::vector<std::string> remarks() const override { return remarks_; }
  ReadingStatement reading() const override { return reading_; }

 private:
  Frame read_frame(std::size_t scan_index, Frame spent) const override;
  void open_stamps(const std::filesystem::path& folder);

  std::vector<StemFile> scans_;
  std::size_t bin_columns_;
  std::vector<std::size_t> point_counts_;
  std::vector<Pose> poses_;
  std::vector<std::int64_t> stamps_ns_;
  std::vector<std::filesystem::path> side_files_;
  std::vector<std::string> remarks_;
  ReadingStatement reading_;
};

}  // namespace mosbench
