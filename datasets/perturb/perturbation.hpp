#pragma once

#include <memory>
#include <string_view>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Parses "KIND=STRENGTH,...,seed=N". Throws UsageError that names the
/// nearest key for unknown ones, and the limits of a strength out of them.
Perturbation parse_perturbation(std::string_view text);

/// Returns whether no kind changes scans or their poses or needs these, so that poses may be found
/// later.
bool changes_points_only(const Perturbation& perturbation);

/// Wraps a sequence so that its scans are disturbed. A disturbed scan depends on the text, the
/// sequence's name and the scan alone. The order of reading, threads and the machine do not matter.
/// Lost points become missing returns (0, 0, 0) with truth 0, so that one label per stored point
/// stays; truth follows the points. Throws UsageError if the sequence lacks what a disturbance
/// needs (stamps, beams, a scan to jump at).
std::unique_ptr<Sequence> perturbed(std::unique_ptr<Sequence> inner,
                                    const Perturbation& perturbation);

}  // namespace mosbench
