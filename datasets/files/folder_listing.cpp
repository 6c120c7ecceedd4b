#include "datasets/files/folder_listing.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/files/shown_text.hpp"
#include "datasets/files/text.hpp"

namespace mosbench {
namespace {

std::vector<std::filesystem::directory_entry> visible_entries(const std::filesystem::path& folder,
                                                              std::error_code& error) {
  std::vector<std::filesystem::directory_entry> entries;
  std::filesystem::directory_iterator entry(folder, error);
  while (!error && entry != std::filesystem::directory_iterator()) {
    if (!entry->path().filename().string().starts_with('.')) entries.push_back(*entry);
    entry.increment(error);
  }
  return entries;
}

bool stem_less(const std::string& a, const std::string& b) {
  return std::pair(stem_number(a), a) < std::pair(stem_number(b), b);
}

void sort_by_stem(std::vector<StemFile>& files) {
  const bool all_numbers = std::ranges::all_of(
      files, [](const StemFile& file) { return stem_number(file.stem).has_value(); });
  std::ranges::sort(files, [all_numbers](const StemFile& a, const StemFile& b) {
    return all_numbers ? stem_less(a.stem, b.stem) : a.stem < b.stem;
  });
  const auto repeated =
      std::ranges::adjacent_find(files, [all_numbers](const StemFile& a, const StemFile& b) {
        return all_numbers ? stem_number(a.stem) == stem_number(b.stem) : a.stem == b.stem;
      });
  if (repeated == files.end()) return;
  throw DataError(std::next(repeated)->file,
                  "stands for the same scan as " + repeated->file.filename().string(),
                  "one file per scan");
}

}  // namespace

std::optional<std::uint64_t> stem_number(std::string_view stem) { return parse_unsigned(stem); }

std::vector<StemFile> list_by_stem(const std::filesystem::path& folder,
                                   std::initializer_list<std::string_view> extensions) {
  std::vector<StemFile> files;
  std::error_code error;
  for (const auto& entry : visible_entries(folder, error)) {
    const std::string extension = entry.path().extension().string();
    if (std::ranges::find(extensions, extension) == extensions.end()) continue;
    files.push_back({entry.path(), shown_in_line(entry.path().stem().string())});
  }
  if (error) {
    throw DataError(folder, "cannot be listed (" + error.message() + ")", "a readable folder");
  }
  sort_by_stem(files);
  return files;
}

std::vector<std::filesystem::path> list_folders(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> folders;
  std::error_code ignored;
  for (const auto& entry : visible_entries(folder, ignored)) {
    if (entry.is_directory(ignored)) folders.push_back(entry.path());
  }
  std::ranges::sort(folders, [](const auto& a, const auto& b) {
    return stem_less(a.filename().string(), b.filename().string());
  });
  return folders;
}

}  // namespace mosbench
