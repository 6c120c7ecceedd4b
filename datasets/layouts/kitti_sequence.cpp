#include "datasets/layouts/kitti_sequence.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/point_records.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

KittiSequence::KittiSequence(std::string name, const std::filesystem::path& folder,
                             const Reading& asked, const SequenceLayout& layout)
    : FolderSequence(std::move(name), folder, asked, layout.folder), layout_(layout) {
  Recording& recording = mutable_recording();
  if (is_there(folder / layout_.label_folder)) {
    label_folder_ = folder / layout_.label_folder;
    pair_labels();
  } else if (labels_in_scans()) {
    for (ScanEntry& entry : recording.scans) entry.has_truth = true;
    recording.remarks.push_back("labels from the field \"label\" of the scans");
  } else {
    recording.remarks.push_back(fmt::format("no {}/: there is no truth", layout_.label_folder));
  }
}

void KittiSequence::pair_labels() {
  Recording& recording = mutable_recording();
  std::unordered_map<std::string, std::size_t> scan_of_stem;
  for (std::size_t k = 0; k < size(); ++k) scan_of_stem.emplace(stem(k), k);
  label_files_.resize(size());
  for (StemFile& label : list_by_stem(label_folder_, {layout_.label_extension})) {
    const auto scan = scan_of_stem.find(label.stem);
    if (scan == scan_of_stem.end() && is_left_out(recording, label.stem)) continue;
    if (scan == scan_of_stem.end()) {
      throw DataError(label.file, "belongs to no scan", "a scan of the same name");
    }
    if (layout_.check_size != nullptr) {
      layout_.check_size(size_of(label.file), point_count(scan->second), label.file);
    }
    recording.scans[scan->second].has_truth = true;
    label_files_[scan->second] = label.file;
    recording.truth_files.push_back(std::move(label.file));
  }
  if (recording.truth_files.size() < size()) {
    recording.remarks.push_back(
        fmt::format("labels for {} of {}", recording.truth_files.size(), counted(size(), "scan")));
  }
}

void KittiSequence::read(std::size_t scan_index, Frame& frame) const {
  if (!has_truth(scan_index) || !label_folder_.empty()) {
    return FolderSequence::read(scan_index, frame);
  }
  const std::filesystem::path& file = *scan_file(scan_index);
  PcdScan scan = parse_pcd(read_file(file), file, reads_times());
  check_count(scan_index, scan.points.size());
  describe(scan_index, frame);
  frame.points = std::move(scan.points);
  frame.point_times_ns = times_ns(scan_index, std::move(scan.times));
  frame.truth = std::move(scan.labels);
}

std::vector<std::uint32_t> KittiSequence::read_truth(std::size_t scan_index) const {
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  if (label_folder_.empty()) return read_pcd_labels(*scan_file(scan_index));
  return layout_.read_labels(label_files_[scan_index], point_count(scan_index));
}

}  // namespace mosbench
