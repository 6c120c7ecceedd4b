#include "datasets/sequence/recording.hpp"

#include <algorithm>

namespace mosbench {

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
