#include "datasets/catalogue.hpp"

#include <algorithm>

namespace mosbench {
namespace {

std::filesystem::path without_slash(const std::filesystem::path& path) {
  const auto normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

std::string folder_name(const std::filesystem::path& path) {
  return without_slash(path).filename().string();
}

std::filesystem::path parent_folder(const std::filesystem::path& path) {
  return without_slash(path).parent_path();
}

std::vector<Split> splits_of_names(const std::vector<NamedSplit>& named,
                                   const std::vector<SequenceFolder>& folders) {
  std::vector<Split> splits;
  for (const NamedSplit& candidate : named) {
    Split split{candidate.name, {}};
    for (std::size_t i = 0; i < folders.size(); ++i) {
      if (std::ranges::find(candidate.sequences, folders[i].name) != candidate.sequences.end()) {
        split.parts.push_back({i, std::nullopt});
      }
    }
    if (!split.parts.empty()) splits.push_back(std::move(split));
  }
  return splits;
}

}  // namespace mosbench
