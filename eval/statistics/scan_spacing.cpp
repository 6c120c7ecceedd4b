#include "eval/statistics/scan_spacing.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/disk/folder_listing.hpp"

namespace mosbench {
namespace {

/// Objects stay in view for so many scans, 3 s at 10 Hz. A measured cell of DOALS holds scans that
/// are 72 to 200 scans apart.
constexpr double kInViewScans = 30.0;
/// Far scans share at most this part of their objects, in the mean over neighbours.
constexpr double kShared = 0.05;
/// Longer numbers are stamps in nanoseconds.
constexpr std::uint64_t kLargestScanNumber = 1'000'000'000'000;
constexpr double kNsPerScan = 1e8;

double number_difference(const std::string& earlier, const std::string& later) {
  const auto from = stem_number(earlier), to = stem_number(later);
  if (!from || !to || *to < *from) return 0.0;
  const auto difference = static_cast<double>(*to - *from);
  return *from > kLargestScanNumber ? difference / kNsPerScan : difference;
}

/// Sums over neighbouring scans.
struct Neighbours {
  double count = 0.0;
  double shared = 0.0;

  /// Scans that have no row lie between others by their names only.
  void add(const Result& result) {
    const std::vector<const ScanRow*> scans = counted_scans(result);
    for (std::size_t k = 1; k < scans.size(); ++k) {
      const double apart_scans = std::max(static_cast<double>(scans[k] - scans[k - 1]),
                                          number_difference(scans[k - 1]->stem, scans[k]->stem));
      shared += std::exp(-apart_scans / kInViewScans);
      count += 1.0;
    }
  }
  Spacing spacing() const {
    return count > 0.0 && shared <= kShared * count ? Spacing::kFar : Spacing::kNear;
  }
};

}  // namespace

Spacing spacing_of(const Result& result) {
  Neighbours neighbours;
  neighbours.add(result);
  return neighbours.spacing();
}

Spacing spacing_of(const ResultSet& set) {
  Neighbours neighbours;
  for (const Result& result : set.sequences) neighbours.add(result);
  return neighbours.spacing();
}

}  // namespace mosbench
