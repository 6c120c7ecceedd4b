#pragma once

#include <cstdlib>
#include <filesystem>

namespace mosbench {

/// Returns the folder beside the project with the owner's data, or the one that MOSBENCH_SHARED
/// names; a user's clone has none.
inline std::filesystem::path shared_folder() {
  const char* elsewhere = std::getenv("MOSBENCH_SHARED");
  return elsewhere != nullptr ? std::filesystem::path(elsewhere)
                              : std::filesystem::path(MOSBENCH_SOURCE_DIR) / "../shared";
}

}  // namespace mosbench
