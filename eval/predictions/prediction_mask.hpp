#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// A scan and the number of labels that a method with a range limit wrote for it.
struct MaskedScan {
  std::filesystem::path file;
  std::size_t labels;
  std::vector<Point> points;
};

/// Finds the range limits, among the usual ones of methods, that leave as many points of every scan
/// as there are labels. Throws DataError if none does, or if several do that leave different
/// points.
RangeGate find_mask(std::span<const MaskedScan> scans);

/// Returns "3 to 50 m" or "from 3 m".
std::string mask_text(const RangeGate& mask);

/// Returns one label per point: those given for the points within `mask`, static for the rest.
/// Throws DataError when their numbers differ.
std::vector<std::uint32_t> spread_over_scan(std::span<const std::uint32_t> labels,
                                            std::span<const Point> points, const RangeGate& mask,
                                            const std::filesystem::path& file);

}  // namespace mosbench
