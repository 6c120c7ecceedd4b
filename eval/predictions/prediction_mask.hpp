#pragma once

#include <cstdint>
#include <filesystem>
#include <mosbench/scan.hpp>
#include <span>
#include <string>
#include <vector>

#include "eval/protocols/protocol.hpp"

namespace mosbench {

/// A scan and how many labels a method that cuts the range wrote for it.
struct MaskedScan {
  std::filesystem::path file;
  std::size_t labels;
  std::vector<Point> points;
};

/// The range limits, among those that programs are known to use, which leave as many points of
/// every scan as there are labels. Throws DataError when none does, or when several do that leave
/// other points.
RangeGate find_mask(std::span<const MaskedScan> scans);

/// "3 to 50 m" or "from 3 m".
std::string mask_text(const RangeGate& mask);

/// One label per point from labels of the points within `mask` only, static for the rest. Throws
/// DataError when there are more or fewer labels than such points.
std::vector<std::uint32_t> spread_over_scan(std::span<const std::uint32_t> labels,
                                            std::span<const Point> points, const RangeGate& mask,
                                            const std::filesystem::path& file);

}  // namespace mosbench
