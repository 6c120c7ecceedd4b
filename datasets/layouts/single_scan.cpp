#include "datasets/layouts/single_scan.hpp"

#include <array>
#include <utility>

#include "datasets/formats/bin_columns.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/sequence/pose_source.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/shown_text.hpp"

namespace mosbench {

SingleScan::SingleScan(std::string name, const std::filesystem::path& file,
                       const ReadingOptions& options)
    : bin_columns_(options.bin_columns.value_or(kUsualBinColumns)) {
  if (options.point_times == PointTimes::kColumn && options.undistorts()) {
    throw UsageError("--point-times column: " + file.string() +
                     " is one scan, expected several to find a motion from");
  }
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), file);
  ScanEntry& entry = recording.scans.emplace_back();
  entry.stem = shown_in_line(file.stem().string());
  entry.file = file;
  if (!options.bin_columns) check_usual_bin_columns(std::array{StemFile{file, entry.stem}});
  entry.points = read_scan_head(file, bin_columns_).points;
  recording.reading = {{"scan_files", file.filename().string()}};
  if (!options.poses) {
    recording.reading.emplace_back("poses", "the identity, of one scan");
    recording.remarks = {"one scan: its pose is the identity"};
    return;
  }
  SensorPoses poses = read_sensor_poses(file.parent_path(), "poses.txt", options, {1, {}});
  entry.map_from_sensor = poses.map_from_sensor.front();
  recording.files = std::move(poses.files);
  recording.remarks = std::move(poses.remarks);
  recording.reading.insert(recording.reading.end(), poses.reading.begin(), poses.reading.end());
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
