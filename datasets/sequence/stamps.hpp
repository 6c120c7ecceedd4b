#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/formats/point_times.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns the median time between scans, in seconds; nothing where stamps are missing, or tell no
/// time that lies between scans.
std::optional<double> usual_step_s(const std::vector<ScanEntry>& scans);

/// Gives scans the stamps of `folder`/times.txt, which joins `files`, else those of their names if
/// these are stamps. The unit is told from the steps, and is stated unless it is the usual: seconds
/// in times.txt, nanoseconds in names. Throws DataError for a file that does not fit.
void read_stamps(const std::filesystem::path& folder, Recording& recording);

/// Judges how the points of a recording keep their times by at most 64 of its scans, and states it.
/// `read` returns what a scan says. A column without a name is no time where it may be the ring.
PointClock judged_clock(Recording& recording,
                        const std::function<std::vector<double>(std::size_t)>& read,
                        std::optional<TimeUnit> told, bool is_named = true);

/// Returns the unit that the user said; nothing for a source of times.
std::optional<TimeUnit> told_unit(const Reading& asked);

}  // namespace mosbench
