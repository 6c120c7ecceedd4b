#include "datasets/kitti_sequence.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <utility>

#include "datasets/errors.hpp"
#include "datasets/files.hpp"
#include "datasets/label_file.hpp"
#include "datasets/scan_file.hpp"

namespace mosbench {

KittiSequence::KittiSequence(std::string name, const std::filesystem::path& folder,
                             const std::optional<std::filesystem::path>& poses_file)
    : name_(std::move(name)), recording_(folder, poses_file), label_files_(recording_.size()) {
  open_labels(folder / "labels");
}

void KittiSequence::open_labels(const std::filesystem::path& folder) {
  if (!is_there(folder)) {
    label_remark_ = "no labels/: there is no truth";
    return;
  }
  std::unordered_map<std::string, std::size_t> scan_of_stem;
  for (std::size_t i = 0; i < size(); ++i) scan_of_stem.emplace(stem(i), i);
  const auto labels = list_by_stem(folder, {".label"});
  for (const StemFile& label : labels) {
    const auto scan = scan_of_stem.find(label.stem);
    if (scan == scan_of_stem.end()) {
      throw DataError(label.file, "belongs to no scan", "a scan of the same name");
    }
    check_label_size(size_of(label.file), point_count(scan->second), label.file);
    label_files_[scan->second] = label.file;
  }
  if (labels.size() < size()) {
    label_remark_ = fmt::format("labels for {} of {} scans", labels.size(), size());
  }
}

bool KittiSequence::has_truth(std::size_t scan_index) const {
  return label_files_.at(scan_index).has_value();
}

Frame KittiSequence::read(std::size_t scan_index) const {
  Frame frame = recording_.read(scan_index);
  if (has_truth(scan_index)) frame.truth = read_truth(scan_index);
  return frame;
}

std::vector<std::uint32_t> KittiSequence::read_truth(std::size_t scan_index) const {
  const auto& file = label_files_.at(scan_index);
  if (!file) {
    throw DataError(recording_.scan(scan_index).file, "has no truth", "a labelled scan");
  }
  return read_labels(*file, point_count(scan_index));
}

std::size_t KittiSequence::point_count(std::size_t scan_index) const {
  return recording_.point_count(scan_index);
}

std::vector<std::filesystem::path> KittiSequence::files() const {
  std::vector<std::filesystem::path> files = recording_.files();
  for (const auto& file : label_files_) {
    if (file) files.push_back(*file);
  }
  return files;
}

std::vector<std::string> KittiSequence::remarks() const {
  std::vector<std::string> remarks = recording_.remarks();
  if (!label_remark_.empty()) remarks.push_back(label_remark_);
  return remarks;
}

}  // namespace mosbench
