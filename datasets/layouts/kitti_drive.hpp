#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/kitti_calib.hpp"
#include "datasets/layouts/boxes.hpp"
#include "datasets/sequence/reading.hpp"

namespace mosbench {

/// A part of the image whose content nobody labelled: left, top, right, bottom.
using ImageRegion = std::array<double, 4>;

/// What the files beside the scans of a drive say. The numbers of its frames start at 0 and are
/// the stems of the scans; frames without a scan are usual.
struct KittiDrive {
  std::string name;
  std::filesystem::path folder;  ///< of the scans
  std::vector<StemFile> scans;
  std::vector<std::optional<FramePose>> frames;
  std::vector<std::optional<std::int64_t>>
      stamps_ns;    ///< of scans, by frame; empty: none are known
  CameraView view;  ///< of what is labelled
  bool has_truth = false;
  std::vector<BoxTrack> tracks;
  std::map<std::size_t, std::vector<ImageRegion>> unlabelled;  ///< by frame
  std::filesystem::path pose_file;                             ///< the last that a writer writes
  std::vector<std::filesystem::path> files;                    ///< that decide poses and stamps
  std::vector<std::filesystem::path> truth_files;
  std::string pose_source, truth_source;  ///< for what is said of the reading
  std::vector<std::string> remarks;
  /// What is not there of oxts and calibration; then there are neither `frames` nor truth. Empty:
  /// all is there.
  std::filesystem::path missing;
};

/// The type of the boxes that `convert` writes: parts of the object with this instance, 0 for none.
std::string type_of_part(std::uint32_t instance);

/// Reads DATE_drive_NNNN_sync/ and the calibration beside it. Throws DataError for what is there
/// and damaged.
KittiDrive read_raw_drive(const std::string& name, const std::filesystem::path& folder);

/// Reads a sequence of the tracking benchmark by its folder velodyne/NNNN. Throws as above.
KittiDrive read_tracking_drive(const std::string& name, const std::filesystem::path& folder);

}  // namespace mosbench
