#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/files/label_file.hpp"
#include "datasets/sequence/recording.hpp"
#include "datasets/sequence/sourced_sequence.hpp"

namespace mosbench {

/// Where a layout keeps what belongs to a sequence, and how its labels are written.
struct SequenceLayout {
  RecordingPlaces places = {};
  std::string label_folder = "labels";
  std::string label_extension = ".label";
  /// Labels of a scan with so many points.
  std::vector<std::uint32_t> (*read_labels)(const std::filesystem::path& file,
                                            std::size_t point_count) = mosbench::read_labels;
  /// Throws DataError for a size that does not fit; null where the size does not tell.
  void (*check_size)(std::uintmax_t size_bytes, std::size_t point_count,
                     const std::filesystem::path& file) = check_label_size;
};

/// One sequence in the SemanticKITTI layout, which Sipailou Campus and HeLiMOS use too: velodyne/,
/// poses.txt, calib.txt, times.txt and labels/, the last three optional; labels may exist for part
/// of the scans. Truth is the raw label ids of the files.
class KittiSequence : public SourcedSequence {
 public:
  /// Throws DataError, also for a label file without scan or of another length than its scan.
  KittiSequence(std::string name, const std::filesystem::path& folder,
                const ReadingOptions& options = {}, SequenceLayout layout = {});

  bool has_truth(std::size_t scan_index) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;
  std::vector<std::filesystem::path> files() const override;
  std::vector<std::string> remarks() const override;

 private:
  void open_labels(const std::filesystem::path& folder);
  void open_label_fields();

  SequenceLayout layout_;
  bool labels_in_scans_ = false;
  std::vector<std::optional<std::filesystem::path>> label_files_;  ///< per scan
  std::string label_remark_;
};

}  // namespace mosbench
