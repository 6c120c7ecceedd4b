#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <string_view>
#include <vector>

namespace mosbench {

/// Returns the labels that the intensities of a scan or a map stand for. Throws DataError for other
/// numbers than 0 and 1: scans that are not the benchmark's hold reflectances, which are no truth.
/// `advice` ends its message.
std::vector<std::uint32_t> kth_truth(const std::vector<Point>& points,
                                     const std::filesystem::path& file,
                                     std::string_view advice = {});

}  // namespace mosbench
