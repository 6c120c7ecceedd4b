#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/sequence.hpp"

namespace mosbench {

struct PerturbKind;

/// One disturbance of a list.
struct PerturbStep {
  const PerturbKind* kind;
  double strength;  ///< in the kind's unit
};

/// The value of --perturb: disturbances in the order in which they apply, and what they share.
struct Perturbation {
  std::vector<PerturbStep> steps;
  std::uint64_t seed = 1;                ///< of everything random
  std::optional<std::size_t> jump_scan;  ///< where poses jump; without it, the middle scan
  std::size_t beams_of = 64;             ///< of the sensor
  std::optional<double> beams_top_deg, beams_bottom_deg;  ///< elevations of the outer beams
  double sensor_range_m = 120.0;  ///< of the weakest target that is seen in clear air
};

/// Parses "KIND=STRENGTH,...,seed=N". Throws UsageError that begins with "--perturb" and names the
/// nearest key for unknown ones, and the limits of a strength out of them.
Perturbation parse_perturbation(std::string_view text);

/// Returns the text that says the same with every shared key that one of the kinds uses, for
/// records: equal texts disturb equally.
std::string to_string(const Perturbation& perturbation);

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
