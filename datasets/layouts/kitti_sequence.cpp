#include "datasets/layouts/kitti_sequence.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/files/files.hpp"
#include "datasets/files/pcd_file.hpp"

namespace mosbench {

KittiSequence::KittiSequence(std::string name, const std::filesystem::path& folder,
                             const ReadingOptions& options, SequenceLayout layout)
    : SourcedSequence(std::move(name), std::make_unique<Recording>(folder, options, layout.places)),
      layout_(std::move(layout)),
      label_files_(size()) {
  open_labels(folder / layout_.label_folder);
}

void KittiSequence::open_labels(const std::filesystem::path& folder) {
  if (!is_there(folder)) {
    open_label_fields();
    if (!labels_in_scans_) {
      label_remark_ = "no " + layout_.label_folder + "/: there is no truth";
    }
    return;
  }
  std::unordered_map<std::string, std::size_t> scan_of_stem;
  for (std::size_t i = 0; i < size(); ++i) scan_of_stem.emplace(stem(i), i);
  const auto labels = list_by_stem(folder, {layout_.label_extension});
  for (const StemFile& label : labels) {
    const auto scan = scan_of_stem.find(label.stem);
    if (scan == scan_of_stem.end()) {
      throw DataError(label.file, "belongs to no scan", "a scan of the same name");
    }
    if (layout_.check_size != nullptr) {
      layout_.check_size(size_of(label.file), point_count(scan->second), label.file);
    }
    label_files_[scan->second] = label.file;
  }
  if (labels.size() < size()) {
    label_remark_ = fmt::format("labels for {} of {} scans", labels.size(), size());
  }
}

/// Point clouds may carry their labels in a field of that name.
void KittiSequence::open_label_fields() {
  for (std::size_t i = 0; i < size(); ++i) {
    const std::filesystem::path file = source().file(i);
    if (file.extension() != ".pcd" || !read_pcd_header(file).has_labels) return;
  }
  labels_in_scans_ = true;
  label_remark_ = "labels from the field \"label\" of the scans";
}

bool KittiSequence::has_truth(std::size_t scan_index) const {
  return labels_in_scans_ || label_files_.at(scan_index).has_value();
}

std::vector<std::uint32_t> KittiSequence::read_truth(std::size_t scan_index) const {
  if (labels_in_scans_) return read_pcd_labels(source().file(scan_index));
  const auto& file = label_files_.at(scan_index);
  if (!file) {
    throw DataError(source().file(scan_index), "has no truth", "a labelled scan");
  }
  return layout_.read_labels(*file, point_count(scan_index));
}

std::vector<std::filesystem::path> KittiSequence::files() const {
  std::vector<std::filesystem::path> files = source().files();
  for (const auto& file : label_files_) {
    if (file) files.push_back(*file);
  }
  return files;
}

std::vector<std::string> KittiSequence::remarks() const {
  std::vector<std::string> remarks = source().remarks();
  if (!label_remark_.empty()) remarks.push_back(label_remark_);
  return remarks;
}

}  // namespace mosbench
