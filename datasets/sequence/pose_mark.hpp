#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/sequence/simulated_origin.hpp"

namespace mosbench {

/// What is to be known of poses wherever they are used.
struct PoseMark {
  std::optional<SimulatedOrigin> simulated;  ///< the scans that they are of
  std::vector<std::string> doubts;

  bool is_set() const { return simulated || !doubts.empty(); }
};

/// Returns the mark of poses of data with such a mark.
PoseMark pose_mark_of(const DataMark& data);

/// Writes FILE.frame beside a file of poses: that they are the lidar's, for which KITTI's rows have
/// no room, the XXH3-64 of `text`, the content of FILE, and the mark. Throws DataError.
void mark_poses(const std::filesystem::path& file, std::string_view text, const PoseMark& mark);

/// Whether FILE.frame holds anything else, which mark_poses would replace.
bool has_foreign_mark(const std::filesystem::path& file);

/// Returns what FILE.frame says of what FILE holds now; nothing where it says nothing of that.
/// Throws DataError where a file cannot be read.
std::optional<PoseMark> pose_mark(const std::filesystem::path& file);

/// Returns what FILE.frame says, else the mark of the data beside which FILE lies; with the doubt
/// that FILE.frame is of other poses where it is of what FILE held before.
PoseMark mark_of_poses(const std::filesystem::path& file);

/// Returns what makes poses of a file doubtful for scans with such a mark; each begins with the
/// file's name.
std::vector<std::string> doubts_of_poses(const std::filesystem::path& file, const DataMark& scans);

}  // namespace mosbench
