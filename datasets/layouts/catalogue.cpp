#include "datasets/layouts/catalogue.hpp"

#include <algorithm>

#include "datasets/files/text.hpp"

namespace mosbench {
std::filesystem::path without_slash(const std::filesystem::path& path) {
  const auto normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

std::string folder_name(const std::filesystem::path& path) {
  return without_slash(path).filename().string();
}

std::filesystem::path parent_folder(const std::filesystem::path& path) {
  return without_slash(path).parent_path();
}

std::optional<std::string> folder_with_word(const std::filesystem::path& path,
                                            std::initializer_list<const char*> words) {
  for (const auto& part : std::filesystem::absolute(path).lexically_normal()) {
    const std::string name = lower_case(part.string());
    for (const char* word : words) {
      if (name.find(word) != std::string::npos) return part.string();
    }
  }
  return std::nullopt;
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
