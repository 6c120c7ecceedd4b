#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/point_times.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Where a layout keeps the scans and the poses of a sequence.
struct FolderLayout {
  std::string_view scan_folder = {};  ///< within the sequence folder, "." for itself; found by
                                      ///< name when empty
  std::string_view poses_file = "poses.txt";
  bool poses_of_lidar = false;  ///< calib.txt is not applied to poses_file
};

/// A sequence folder with one file per scan, poses in a text file, and stamps in times.txt or in
/// the names of the scans where there are any. Opening checks scan sizes and all counts. Its
/// truth are the labels that scans hold, if a layout takes them.
class FolderSequence : public Sequence {
 public:
  /// Reads poses by `place_scans`. Throws DataError.
  FolderSequence(std::string name, const std::filesystem::path& folder, const Reading& asked,
                 const FolderLayout& layout = {});

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 protected:
  /// Takes the labels that points of scans have as truth, and returns how many scans have some.
  std::size_t take_labels_of_scans();
  /// Reads the points of a scan alone.
  std::vector<Point> read_points(std::size_t scan_index, std::vector<Point> reused = {}) const;

 private:
  /// Whether the times of points are to be read from the scans, and what they are after its stamp.
  bool reads_times() const { return clock_.knows_unit(); }
  std::vector<std::int64_t> times_ns(std::size_t scan_index, std::vector<double> times) const;
  void list_scans(const std::filesystem::path& folder, const FolderLayout& layout,
                  bool columns_are_usual);
  void judge_times(const Reading& asked);

  std::size_t bin_columns_;
  bool times_in_column_;
  bool times_in_fields_ = true;
  bool truth_in_scans_ = false;
  std::vector<bool> labelled_;  ///< by number of a scan, whether its points have labels
  PointClock clock_;
};

}  // namespace mosbench
