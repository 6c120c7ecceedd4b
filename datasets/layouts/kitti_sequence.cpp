#include "datasets/layouts/kitti_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

std::string doubt_of_note(const std::filesystem::path& file) {
  const nlohmann::ordered_json json = parse_json(read_file(file), file);
  if (json.is_object() && json.contains("doubt") && json["doubt"].is_string()) {
    return json["doubt"];
  }
  throw DataError(file, "has no \"doubt\"", "the file as `mosbench truth write` wrote it");
}

}  // namespace

bool has_unsure_truth(const Recording& recording) {
  const std::vector<std::filesystem::path>& files = recording.truth_files;
  return !files.empty() && is_there(files.front().parent_path() / kTruthNote);
}

KittiSequence::KittiSequence(std::string name, const std::filesystem::path& folder,
                             const Reading& asked, const SequenceLayout& layout)
    : FolderSequence(std::move(name), folder, asked, layout.folder), layout_(layout) {
  if (is_there(folder / layout_.label_folder)) {
    label_folder_ = folder / layout_.label_folder;
    pair_labels();
  } else {
    remark_on_labels(take_labels_of_scans());
  }
}

void KittiSequence::remark_on_labels(std::size_t labelled) {
  Recording& recording = mutable_recording();
  if (labelled == 0) {
    recording.remarks.push_back(fmt::format("no {}/: there is no truth", layout_.label_folder));
  } else if (labelled == size()) {
    recording.remarks.push_back("labels from the field \"label\" of the scans");
  } else {
    recording.remarks.push_back(fmt::format("labels from the field \"label\" of {} of {}", labelled,
                                            counted(size(), "scan")));
  }
}

void KittiSequence::pair_labels() {
  Recording& recording = mutable_recording();
  std::unordered_map<std::string, std::size_t> scan_of_stem;
  for (std::size_t k = 0; k < size(); ++k) scan_of_stem.emplace(stem(k), k);
  label_files_.resize(size());
  for (StemFile& label : list_by_stem(label_folder_, layout_.label_extensions)) {
    const auto scan = scan_of_stem.find(label.stem);
    if (scan == scan_of_stem.end() && is_left_out(recording, label.stem)) continue;
    if (scan == scan_of_stem.end()) {
      throw DataError(label.file, "belongs to no scan", "a scan of the same name");
    }
    check_labels_fit(label.file, point_count(scan->second));
    recording.scans[scan->second].has_truth = true;
    label_files_[scan->second] = label.file;
    recording.truth_files.push_back(std::move(label.file));
  }
  if (recording.truth_files.size() < size()) {
    recording.remarks.push_back(
        fmt::format("labels for {} of {}", recording.truth_files.size(), counted(size(), "scan")));
  }
  const std::filesystem::path note = label_folder_ / kTruthNote;
  if (is_there(note)) recording.doubts.push_back(doubt_of_note(note));
}

std::vector<std::uint32_t> KittiSequence::read_truth(std::size_t scan_index) const {
  if (label_folder_.empty()) return FolderSequence::read_truth(scan_index);
  if (!has_truth(scan_index)) refuse_truth(scan_index);
  const std::filesystem::path& file = label_files_[scan_index];
  if (tells_points(file)) {
    check_same_points(file, read_points(scan_index), scan_file(scan_index)->filename().string());
  }
  return layout_.read_labels(file, point_count(scan_index));
}

}  // namespace mosbench
