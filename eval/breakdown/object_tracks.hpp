#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "datasets/sequence/sequence.hpp"
#include "eval/breakdown/scan_breakdown.hpp"

namespace mosbench {

/// When scans were taken.
struct ScanClock {
  std::vector<double> times_s;  ///< one per scan, since any time that all share
  bool stamped = false;         ///< by the scans' stamps; otherwise 10 Hz is assumed
};

/// Returns the times of the scans at `scans`: their stamps where each has one and they rise, else
/// 0.1 s times their index.
ScanClock scan_times(const Sequence& sequence, const std::vector<std::size_t>& scans);

/// A moving object seen in one scan.
struct Sighting {
  std::size_t scan_index;  ///< in its sequence
  double time_s;           ///< since any time that all scans share
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
  /// Speed of the centre in the map: the median over all intervals of about a second, so that
  /// neither a change of what is seen of the object nor a turn decides; for shorter tracks over the
  /// whole track. nullopt for a single scan.
  std::optional<double> speed_m_s() const;
  /// Scans from the first sighting to the first with a tenth of its points found; nullopt if there
  /// is none.
  std::optional<std::size_t> detection_delay_scans() const;
};

/// Moving objects in the truth of one scan.
struct ScanObjects {
  std::size_t scan_index;
  double time_s;
  std::vector<ScanCluster> objects;
};

/// Links clusters over labelled scans: by instance where they have one, otherwise to the track
/// whose predicted position is nearest (nearest pairs first), at most 2 m away and unseen for at
/// most 5 scans. Deterministic; ordered by first sighting.
std::vector<ObjectTrack> link_objects(std::span<const ScanObjects> scans);

}  // namespace mosbench
