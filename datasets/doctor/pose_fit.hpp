#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/doctor/pose_evidence.hpp"

// How well scans fit one another under the given poses: how far the poses put the surfaces that two
// scans share apart, from where scan matching puts them.

namespace mosbench {

/// How much is measured.
enum class FitDetail : std::uint8_t {
  kBrief,  ///< at few places the farthest scans that can be matched, to cost a run little
  kFull    ///< from scan to scan, 5 and 20 scans apart
};

/// Measures how far off the poses are at places spread over the sequence, and where most. Leaves no
/// facts where scan matching tells nothing. Throws DataError.
void examine_pose_fit(const Sequence& sequence, const std::vector<Pose>& given, FitDetail detail,
                      Facts& facts);

/// Returns a sentence for given poses that do not fit, or jump where the scans do not, from few
/// scans; nothing where the poses were disturbed on purpose. Throws DataError.
std::optional<std::string> doubt_about_pose_fit(const Sequence& sequence);

}  // namespace mosbench
