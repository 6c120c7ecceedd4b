#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns the LiDAR's poses at any time by the file of poses that `place_scans` reads; nothing
/// where these have no stamps. Throws DataError.
PoseAt stamped_poses(const std::filesystem::path& folder, const std::string& own_file,
                     const Reading& asked);

/// Moves the clock of the poses by up to 1.2 s, and looks when some scans, put together by the
/// poses, have the thinnest surfaces. Returns a sentence where that is at another time than their
/// stamps say; nothing where the sensor moves so evenly that another clock changes nothing. Reads
/// at most 20 scans. Throws DataError.
std::optional<std::string> doubt_about_clock(const Sequence& sequence, const PoseAt& pose_at);

}  // namespace mosbench
