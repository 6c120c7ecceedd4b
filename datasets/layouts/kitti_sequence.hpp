#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/label_formats.hpp"
#include "datasets/sequence/folder_sequence.hpp"

namespace mosbench {

/// Beside labels that `mosbench truth write` wrote: where they come from.
inline constexpr const char* kTruthNote = "truth.json";

/// Returns whether the note lies beside the truth: points of id 0 are unsure there.
bool has_unsure_truth(const Recording& recording);

/// Where a layout keeps what belongs to a sequence, and how its labels are written.
struct SequenceLayout {
  FolderLayout folder = {};
  std::string_view label_folder = "labels";
  std::vector<std::string_view> label_extensions = kLabelExtensions;
  /// Reads the labels of a scan with `point_count` points.
  std::vector<std::uint32_t> (*read_labels)(const std::filesystem::path& file,
                                            std::size_t point_count) = read_any_labels;
};

/// One sequence in the SemanticKITTI layout, which Sipailou Campus and HeLiMOS use too: velodyne/,
/// poses.txt, calib.txt, times.txt and labels/, the last three optional; labels may exist for part
/// of the scans. Truth is the raw label ids of the files, or without labels/ those that the points
/// of .pcd and .ply scans have.
class KittiSequence : public FolderSequence {
 public:
  /// Throws DataError, also for a label file without scan or of another length than its scan.
  KittiSequence(std::string name, const std::filesystem::path& folder, const Reading& asked = {},
                const SequenceLayout& layout = {});

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  void pair_labels();
  void remark_on_labels(std::size_t labelled);

  SequenceLayout layout_;
  std::filesystem::path label_folder_;              ///< empty when the labels are in the scans
  std::vector<std::filesystem::path> label_files_;  ///< by scan; empty for those without
};

}  // namespace mosbench
