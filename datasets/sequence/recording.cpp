#include "datasets/sequence/recording.hpp"

namespace mosbench {

std::vector<std::filesystem::path> files_of(const Recording& recording) {
  std::vector<std::filesystem::path> files = recording.files;
  for (const ScanEntry& scan : recording.scans) {
    if (scan.file) files.push_back(*scan.file);
  }
  files.insert(files.end(), recording.truth_files.begin(), recording.truth_files.end());
  return files;
}

}  // namespace mosbench
