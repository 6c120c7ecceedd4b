#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/reading.hpp"

namespace mosbench {

/// Folders of a file per scan that a run keeps beside its result.json.
inline constexpr std::array<std::string_view, 4> kScanFileFolders = {"labels", "scores", "reasons",
                                                                     "moving"};

/// Name of a sequence, which is also its folder below those of results: the name of a folder, or
/// two with a slash between as in "station/sequence_1".
class SequenceName {
 public:
  SequenceName() = default;
  /// Takes what `file`, a result.json or the sequence's folder, says. Throws DataError naming it
  /// unless every part is UTF-8 of 1 to 255 bytes without control characters, no "." or "..", and
  /// none that results use themselves: kScanFileFolders, result.json, *.partial, *.replaced.
  SequenceName(std::string text, const std::filesystem::path& file);

  const std::string& text() const { return text_; }
  operator const std::string&() const { return text_; }
  /// Relative, and below the folder that it is appended to.
  std::filesystem::path folder() const { return text_; }
  auto operator<=>(const SequenceName&) const = default;

 private:
  std::string text_;
};

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
