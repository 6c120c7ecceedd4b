#include "datasets/sequence/recording.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

constexpr std::size_t kLongest_bytes = 255;
constexpr std::ptrdiff_t kMostSlashes = 1;

bool is_of_results(std::string_view part) {
  return std::ranges::find(kScanFileFolders, part) != kScanFileFolders.end() ||
         part == "result.json" || part.ends_with(".partial") || part.ends_with(".replaced");
}

void check_part(std::string_view part, const std::string& text, const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& expected) {
    throw DataError(file, fmt::format("names the sequence \"{}\"", shown_in_line(text)), expected);
  };
  if (part.empty() || part == "." || part == "..") refuse("a folder below that of results");
  if (part.size() > kLongest_bytes) refuse("at most 255 bytes");
  if (!is_printable(part)) refuse("UTF-8 without control characters");
  if (is_of_results(part)) {
    refuse(fmt::format(
        "another name: results use {}, result.json, *.partial and *.replaced themselves",
        fmt::join(kScanFileFolders, ", ")));
  }
}

}  // namespace

SequenceName::SequenceName(std::string text, const std::filesystem::path& file)
    : text_(std::move(text)) {
  if (std::ranges::count(text_, '/') > kMostSlashes) {
    throw DataError(file, fmt::format("names the sequence \"{}\"", shown_in_line(text_)),
                    "one folder, or a scene and a folder");
  }
  for (std::string_view rest = text_;;) {
    const std::size_t slash = rest.find('/');
    check_part(rest.substr(0, slash), text_, file);
    if (slash == std::string_view::npos) return;
    rest.remove_prefix(slash + 1);
  }
}

bool is_left_out(const Recording& recording, const std::string& stem) {
  return std::ranges::find(recording.left_out, stem, &ScanEntry::stem) != recording.left_out.end();
}

std::vector<std::filesystem::path> files_of(const Recording& recording) {
  std::vector<std::filesystem::path> files = recording.files;
  for (const ScanEntry& scan : recording.scans) {
    if (scan.file) files.push_back(*scan.file);
  }
  files.insert(files.end(), recording.truth_files.begin(), recording.truth_files.end());
  return files;
}

}  // namespace mosbench
