#include "eval/truth/truth_scan.hpp"

#include <algorithm>

#include "datasets/formats/label_file.hpp"
#include "datasets/formats/point_range.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {

TruthScan read_truth_scan(const ResultScans& scans, std::span<const MadeTrack> made,
                          std::size_t scan_index) {
  const Result& run = scans.result();
  const Frame frame = scans.sequence().read(scan_index);
  TruthScan scan;
  for (const Point& point : frame.points) {
    scan.positions_m.push_back(frame.map_from_sensor * position_of(point));
  }
  scan.objects = read_labels(object_file(run.folder(), frame.stem), frame.points.size());
  apply_edits(made, run.sequence.text(), scan_index, scan.positions_m, scan.objects);
  return scan;
}

TrackEdit with_points(TrackEdit edit, const ResultScans& scans, std::span<const MadeTrack> made) {
  constexpr std::uint32_t kNew = 0xFFFFFFFF;
  const std::size_t end = std::min(edit.last_scan + 1, scans.rows().size());
  TrackEdit counted{.first_scan = end, .corners_m = edit.corners_m};
  const std::vector<MadeTrack> by_edit = {{scans.result().sequence.text(), kNew, edit}};
  for (std::size_t k = edit.first_scan; k < end; ++k) {
    TruthScan scan = read_truth_scan(scans, made, k);
    const std::vector<std::uint32_t> before = scan.objects;
    apply_edits(by_edit, by_edit.front().sequence, k, scan.positions_m, scan.objects);
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (scan.objects[i] != kNew) continue;
      ++counted.takes[before[i]];
      counted.first_scan = std::min(counted.first_scan, k);
      counted.last_scan = k;
    }
  }
  if (!counted.takes.empty()) return counted;
  throw DataError("request", "holds no points", "a cut, a polygon or tracks that hold some");
}

}  // namespace mosbench
