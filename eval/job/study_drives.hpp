#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "eval/job/study_cells.hpp"

// Which cells of a study read the same drive: what tells its scans from others, wherever they lie
// and whatever they are called.

namespace mosbench {

/// Returns "scene 5f3a... seed 7": one drive, whatever its layout and length.
std::string simulated_drive(const std::string& scene_fingerprint, std::uint64_t seed);

/// Returns the same for a sequence on disk, whichever of its scans are read. Throws DataError.
std::string drive_of(const Data& data, const std::string& sequence);

/// Throws UsageError for a tuning that judges on scans that it tunes on; other scans of a drive may
/// be judged.
void check_drives(const Study& study, const std::vector<StudyCell>& cells);

}  // namespace mosbench
