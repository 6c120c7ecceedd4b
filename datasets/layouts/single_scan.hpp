#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// One scan file (.bin, .pcd or .ply) as a sequence of its own. Its pose is the identity unless
/// `options.poses` names a file with one. It has no truth.
class SingleScan : public Sequence {
 public:
  /// Throws DataError for a file that is no scan, UsageError for times of points in a column: one
  /// scan alone shows no motion to correct.
  SingleScan(std::string name, const std::filesystem::path& file, const Reading& asked);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;

 private:
  std::size_t bin_columns_;
};

}  // namespace mosbench
