#include "datasets/layouts/single_scan.hpp"

#include <array>
#include <utility>

#include "datasets/formats/bin_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {

SingleScan::SingleScan(std::string name, const std::filesystem::path& file, const Reading& asked)
    : bin_columns_(asked.bin_columns.value_or(kUsualBinColumns)) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), file);
  ScanEntry& entry = recording.scans.emplace_back();
  entry.stem = shown_in_line(file.stem().string());
  entry.file = file;
  if (!asked.bin_columns) check_usual_bin_columns(std::array{StemFile{file, entry.stem}});
  entry.points = read_scan_head(file, bin_columns_).points;
  recording.reading.scan_files = file.filename().string();
  if (asked.pose_file() != nullptr) {
    place_scans(file.parent_path(), "poses.txt", asked, recording);
    return;
  }
  recording.reading.poses.source = "the identity, of one scan";
  recording.remarks = {"one scan: its pose is the identity"};
}

void SingleScan::read(std::size_t scan_index, Frame& frame) const {
  const ScanEntry& entry = scan(scan_index);
  frame.points = read_scan(*entry.file, bin_columns_, std::move(frame.points));
  if (frame.points.size() != entry.points) {
    throw DataError(*entry.file, "changed since it was opened",
                    std::to_string(entry.points) + " points");
  }
  describe(scan_index, frame);
  frame.point_times_ns.clear();
  frame.truth.reset();
}

std::vector<std::uint32_t> SingleScan::read_truth(std::size_t scan_index) const {
  refuse_truth(scan_index);
}

}  // namespace mosbench
