#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "eval/breakdown/scan_breakdown.hpp"

namespace mosbench {

/// A moving object seen in one scan.
struct Sighting {
  std::size_t scan_index;  ///< in its sequence
  double time_s;           ///< since any start that all scans share
  ScanCluster cluster;
};

/// A moving object over scans.
struct ObjectTrack {
  std::vector<Sighting> sightings;  ///< in scan order, at least one

  std::size_t points() const;
  std::size_t found() const;
  double recall() const { return static_cast<double>(found()) / static_cast<double>(points()); }
  double mean_range_m() const;
  double largest_size_m() const;
  /// Speed of the centre in the map: the median over all stretches of about a second, so that
  /// neither a change of what is seen of the object nor a turn decides; over its whole life when
  /// that is shorter. Nothing for a single scan.
  std::optional<double> speed_m_s() const;
  /// Scans from the first sighting to the first with a tenth of its points found; nothing when that
  /// never happens.
  std::optional<std::size_t> detection_delay_scans() const;
};

/// What the truth of one labelled scan holds.
struct ScanObjects {
  std::size_t scan_index;
  double time_s;
  std::vector<ScanCluster> objects;
};

/// Links clusters over labelled scans: by instance where they have one, else the nearest pairs of
/// cluster and where a track would be now come first, up to 2 m apart, over gaps of at most 5
/// scans. The same input gives the same tracks; ordered by first sighting.
std::vector<ObjectTrack> link_objects(std::span<const ScanObjects> scans);

}  // namespace mosbench
