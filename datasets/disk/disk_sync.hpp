#pragma once

#include <filesystem>

namespace mosbench {

/// Waits until the names in a folder are on the disk, so that a file that was renamed there
/// survives a power cut. Throws DataError.
void sync_names_of(const std::filesystem::path& folder);

/// Waits until all that was written so far to the file system of `folder` is on the disk: for a
/// folder of thousands of files a small part of what waiting for each would take. Throws DataError.
void sync_file_system_of(const std::filesystem::path& folder);

}  // namespace mosbench
