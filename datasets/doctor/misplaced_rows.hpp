#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Two rows of a pose file that were exchanged, or a single one (`first` == `second`) that is away
/// from the trajectory of its neighbours. Counted from 0.
struct MisplacedRows {
  std::size_t first = 0, second = 0;

  bool single() const { return first == second; }
};

/// Returns the poses with the two rows exchanged, or the single one midway between its neighbours.
std::vector<Pose> mended(std::vector<Pose> poses, const MisplacedRows& rows);

/// Returns rows (worst first) whose removal shortens the trajectory by more than a typical step and
/// clearly more than a typical detour. Only poses are examined, so a real jerk may be among them.
std::vector<MisplacedRows> suspected_rows(std::vector<Pose> poses);

/// Suspected rows with what scans say of them.
struct MisplacedRowsFound {
  std::vector<MisplacedRows> rows;  ///< those without which scans overlap better, too
  /// By how much scans overlap better per pair without any that was suspected, at most; 0 without.
  double largest_gain = 0.0;
};

/// Reads the scans around suspected rows only. Throws DataError.
MisplacedRowsFound misplaced_rows(const Sequence& sequence, const std::vector<Pose>& poses);

}  // namespace mosbench
