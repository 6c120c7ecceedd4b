#include "datasets/disk/folder_listing.hpp"

#include <algorithm>
#include <system_error>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

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

/// Takes the digits that `text` begins with off it, and returns them without zeros in front.
std::string_view take_number(std::string_view& text) {
  const auto digits =
      static_cast<std::size_t>(std::ranges::find_if_not(text, is_digit) - text.begin());
  std::string_view number = text.substr(0, digits);
  text.remove_prefix(digits);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

/// Below 0 where `a` comes before `b`: numbers by value, what lies between them by text. Digits
/// behind a point that follows a digit are a fraction, 1650.5 comes after 1650.123.
int in_order(std::string_view a, std::string_view b) {
  bool after_digit = false, in_fraction = false;
  while (!a.empty() && !b.empty()) {
    if (!in_fraction && is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view one = take_number(a), other = take_number(b);
      if (one.size() != other.size()) return one.size() < other.size() ? -1 : 1;
      if (const int order = one.compare(other); order != 0) return order;
      after_digit = true;
      continue;
    }
    // Not as char, whose sign depends on the machine.
    if (a.front() != b.front()) return a.substr(0, 1).compare(b.substr(0, 1));
    in_fraction = is_digit(a.front()) ? in_fraction : a.front() == '.' && after_digit;
    after_digit = in_fraction || is_digit(a.front());
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  return a.empty() ? (b.empty() ? 0 : -1) : 1;
}

void sort_by_stem(std::vector<StemFile>& files) {
  std::ranges::sort(
      files, [](const StemFile& a, const StemFile& b) { return in_order(a.stem, b.stem) < 0; });
  const auto repeated = std::ranges::adjacent_find(
      files, [](const StemFile& a, const StemFile& b) { return in_order(a.stem, b.stem) == 0; });
  if (repeated == files.end()) return;
  throw DataError(std::next(repeated)->file,
                  "stands for the same scan as " + repeated->file.filename().string(),
                  "one file per scan");
}

}  // namespace

std::optional<std::uint64_t> stem_number(std::string_view stem) { return parse_unsigned(stem); }

std::vector<StemFile> list_by_stem(const std::filesystem::path& folder,
                                   const std::vector<std::string_view>& extensions) {
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
    return in_order(a.filename().string(), b.filename().string()) < 0;
  });
  return folders;
}

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
