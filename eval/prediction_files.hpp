#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/sequence.hpp"

namespace mosbench {

/// Label files that somebody predicted for one sequence, paired with scans by file stem.
class PredictionFolder {
 public:
  explicit PredictionFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }

  /// Throws DataError naming the file when one of the `wanted` scans has none or one of another
  /// size, or when a label file belongs to no scan of the sequence.
  void check(const Sequence& sequence, const std::vector<std::size_t>& wanted) const;

  /// Raw labels of one scan; throws DataError.
  std::vector<std::uint32_t> read(const std::string& stem, std::size_t point_count) const;

 private:
  std::filesystem::path file(const std::string& stem) const { return folder_ / (stem + ".label"); }

  std::filesystem::path folder_;
};

/// Where below `root` the predictions of a sequence lie: the layouts of `mosbench run` and of
/// semantic-kitti-api; `root` itself only for an `only_sequence`. Throws DataError when there are
/// none, or when they are the truth itself.
PredictionFolder find_predictions(const std::filesystem::path& root, const Sequence& sequence,
                                  bool only_sequence);

}  // namespace mosbench
