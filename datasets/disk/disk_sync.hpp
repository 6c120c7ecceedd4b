#pragma once

#include <filesystem>

namespace mosbench {

/// Waits until the names in a folder are on the disk, so that a file that was renamed there
/// survives a power cut. Throws DataError.
void sync_names_of(const std::filesystem::path& folder);

/// Waits until the file system of `folder` has brought to the disk all that was written so far. For
/// a folder of thousands of files this takes a small part of waiting for each. Throws DataError.
void sync_file_system_of(const std::filesystem::path& folder);

}  // namespace mosbench
