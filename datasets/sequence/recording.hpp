#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/reading.hpp"
#include "datasets/sequence/sequence_name.hpp"

namespace mosbench {

/// What is known of a scan before it is read.
struct ScanEntry {
  std::string stem;                           ///< file name without extension
  std::optional<std::filesystem::path> file;  ///< the one that holds this scan and nothing else
  std::optional<std::int64_t> stamp_ns;
  Pose map_from_sensor = Pose::Identity();  ///< LiDAR frame, at the scan's stamp
  std::size_t points = 0;
  bool has_truth = false;
};

/// What is known of a sequence once it is opened.
struct Recording {
  SequenceName name;  ///< unique in a data set
  std::vector<ScanEntry> scans;
  std::vector<ScanEntry> left_out;  ///< scans on disk whose pose is not known; without truth
  /// Files that decide what is read besides those of single scans: bag, poses, calibration, times.
  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> truth_files;
  /// Plain sentences on what was assumed or found odd (pose frame, missing labels).
  std::vector<std::string> remarks;
  /// What was read in which convention; two runs on the same files may differ in it.
  ReadingDone reading;
  bool has_radial_velocities = false;  ///< whether frames have them
};

/// Returns whether a stem is that of a scan that was left out.
bool is_left_out(const Recording& recording, const std::string& stem);

/// Returns every file that decides the content, for fingerprints: `files`, scans, `truth_files`.
std::vector<std::filesystem::path> files_of(const Recording& recording);

}  // namespace mosbench
