#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns the labels that the intensities of a scan or a map stand for. Throws DataError for other
/// numbers than 0 and 1: scans that are not the benchmark's hold reflectances, which are no truth.
/// `advice` ends its message.
std::vector<std::uint32_t> kth_truth(const std::vector<Point>& points,
                                     const std::filesystem::path& file,
                                     std::string_view advice = {});

/// One sequence of KTH's DynamicMap_Benchmark: pcd/*.pcd with points in the map's frame, the
/// sensor's pose in VIEWPOINT, and in intensity 1 for what is dynamic. Frames have the points in
/// the sensor's frame and without intensity, which is the truth and hidden from a method. Reading
/// throws DataError for an intensity other than 0 and 1.
class KthSequence : public Sequence {
 public:
  /// Throws DataError when a scan has no VIEWPOINT.
  KthSequence(std::string name, const std::filesystem::path& folder);

  using Sequence::read;
  void read(std::size_t scan_index, Frame& frame) const override;
  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override;
};

}  // namespace mosbench
