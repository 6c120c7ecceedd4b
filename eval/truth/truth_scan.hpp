#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "eval/result/result_scans.hpp"
#include "eval/truth/track_edits.hpp"

namespace mosbench {

/// The points of a scan with the track of each, after edits.
struct TruthScan {
  std::vector<Eigen::Vector3d> positions_m;  ///< in the map
  std::vector<std::uint32_t> objects;        ///< 0: of no track
};

/// Reads a scan of a run that kept objects. Throws DataError.
TruthScan read_truth_scan(const ResultScans& scans, std::span<const MadeTrack> made,
                          std::size_t scan_index);

/// Returns an edit with the points that it takes from the tracks it names, and the scans cut to
/// where it takes some. Throws DataError where there are none, and for scans that are not there.
TrackEdit with_points(TrackEdit edit, const ResultScans& scans, std::span<const MadeTrack> made);

}  // namespace mosbench
