#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/recording.hpp"
#include "datasets/sequence.hpp"

namespace mosbench {

/// One sequence in the SemanticKITTI layout, which Sipailou Campus and HeLiMOS use too: velodyne/,
/// poses.txt, calib.txt, times.txt and labels/, the last three optional; labels may exist for part
/// of the scans. Truth is the raw label ids of the files.
class KittiSequence : public Sequence {
 public:
  /// Throws DataError, also for a label file without scan or of another length than its scan.
  KittiSequence(std::string name, const std::filesystem::path& folder,
                const std::optional<std::filesystem::path>& poses_file = std::nullopt);

  std::string name() const override { return name_; }
  std::size_t size() const override { return recording_.size(); }
  std::string stem(std::size_t scan_index) const override {
    return recording_.scan(scan_index).stem;
  }
  bool has_truth(std::size_t scan_index) const override;
  Frame read(std::size_t scan_index) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;
  std::size_t point_count(std::size_t scan_index) const override;
  std::vector<std::filesystem::path> files() const override;
  std::vector<std::string> remarks() const override;

 private:
  void open_labels(const std::filesystem::path& folder);

  std::string name_;
  Recording recording_;
  std::vector<std::optional<std::filesystem::path>> label_files_;  ///< per scan
  std::string label_remark_;
};

}  // namespace mosbench
