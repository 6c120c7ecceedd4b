#pragma once

#include <cstddef>
#include <mosbench/scan.hpp>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Two rows of a pose file that were exchanged, or a single one (`first` == `second`) that lies
/// off the way between its neighbours. From 0.
struct MisplacedRows {
  std::size_t first = 0, second = 0;

  bool single() const { return first == second; }
};

/// The poses with the two rows exchanged, or with the single one put midway between its neighbours.
std::vector<Pose> mended(std::vector<Pose> poses, const MisplacedRows& rows);

/// The rows, worst first, without which the way is shorter by more than a usual step and clearly
/// more than its usual detours. Looks at the poses alone, so that a real jerk is among them.
std::vector<MisplacedRows> suspected_rows(std::vector<Pose> poses);

/// Those suspected rows without which scans overlap better as well. Reads the scans around the
/// suspected rows, none when there are none. Throws DataError.
std::vector<MisplacedRows> misplaced_rows(const Sequence& sequence, const std::vector<Pose>& poses);

}  // namespace mosbench
