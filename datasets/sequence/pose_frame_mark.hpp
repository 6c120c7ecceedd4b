#pragma once

#include <filesystem>
#include <string_view>

namespace mosbench {

/// Writes FILE.frame beside a file of poses in KITTI's rows, which have no room to say whose poses
/// they are: that these are the lidar's, and the XXH3-64 of `text`, the content of FILE. Throws
/// DataError.
void mark_as_lidars(const std::filesystem::path& file, std::string_view text);

/// Whether FILE.frame says so of what FILE holds now. Throws DataError where a file cannot be read.
bool is_marked_as_lidars(const std::filesystem::path& file);

}  // namespace mosbench
