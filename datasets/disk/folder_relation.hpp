#pragma once

#include <filesystem>

namespace mosbench {

/// Returns the path from the root with symbolic links resolved as far as they can be.
std::filesystem::path resolved(const std::filesystem::path& path);

/// Returns whether `path` is `folder` or below it; both as `resolved` returns them.
bool is_in(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace mosbench
