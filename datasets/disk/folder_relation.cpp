#include "datasets/disk/folder_relation.hpp"

#include <algorithm>
#include <system_error>

namespace mosbench {

std::filesystem::path resolved(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::path real = std::filesystem::weakly_canonical(path, error);
  if (error) real = path;
  real = std::filesystem::absolute(real).lexically_normal();
  return real.has_filename() ? real : real.parent_path();
}

bool is_in(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

}  // namespace mosbench
