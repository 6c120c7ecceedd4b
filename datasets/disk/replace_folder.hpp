#pragma once

#include <filesystem>

namespace mosbench {

/// Puts the folder `fresh`, which lies beside `folder`, in place of it and removes the old content.
/// All of `fresh` is on the disk before. After a kill or a power cut, the old or the new folder is
/// whole under its name. If the file system cannot exchange names (NFS), the old one may be at
/// replaced_by(folder). Throws DataError.
void replace_folder(const std::filesystem::path& fresh, const std::filesystem::path& folder);

/// Returns the name of the folder that is about to be removed because another one takes its place.
std::filesystem::path replaced_by(const std::filesystem::path& folder);

/// Brings back what a killed replace_folder left at replaced_by(folder) when nothing is at
/// `folder`.
void restore_folder(const std::filesystem::path& folder);

}  // namespace mosbench
