#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sequence/corrected_sequence.hpp"
#include "datasets/sequence/sequence.hpp"

namespace mosbench {

/// Returns the LiDAR's poses at any time by the file of poses that `place_scans` reads; nothing
/// where these have no stamps. Throws DataError.
PoseAt stamped_poses(const std::filesystem::path& folder, const std::string& own_file,
                     const Reading& asked);

/// Returns how far stamps of poses lie behind those of the scans that they belong to, where that is
/// about the same for all: the poses have the time of another clock, or of their recording.
std::optional<std::int64_t> constant_offset_ns(const std::vector<std::int64_t>& poses_ns,
                                               const std::vector<std::int64_t>& scans_ns);

/// What is odd about the clock of poses.
struct ClockDoubt {
  std::string what;
  std::optional<double> offset_s;  ///< `pose_offset_s` that mends it
};
/// Returns the sentence with what mends it, for users.
std::string to_string(const ClockDoubt& doubt);
/// Adds it to the doubts of a recording. An offset that stamps showed wins over one close to it.
void add_clock_doubt(Recording& recording, ClockDoubt doubt);
/// Returns the offset that mends poses that are read by `asked_s` and are `late_s` late.
double mending_offset_s(double asked_s, double late_s);

/// Moves the clock of the poses by up to 1.2 s, and looks when some scans, put together by the
/// poses, have the thinnest surfaces. Returns a doubt where that is at another time than their
/// stamps say; nothing where the sensor moves so evenly that another clock changes nothing. Reads
/// at most 20 scans. Throws DataError.
std::optional<ClockDoubt> doubt_about_clock(const Sequence& sequence, const PoseAt& pose_at);

}  // namespace mosbench
