#include "datasets/layouts/kth_sequence.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

std::string other_scans() {
  return "; " + option("dataset", "semantickitti") + " reads other scans";
}

}  // namespace

std::vector<std::uint32_t> kth_truth(const std::vector<Point>& points,
                                     const std::filesystem::path& file, std::string_view advice) {
  std::vector<std::uint32_t> truth;
  truth.reserve(points.size());
  for (const Point& point : points) {
    if (point.intensity != 0.0F && point.intensity != 1.0F) {
      throw DataError(file, fmt::format("point {} has intensity {}", truth.size(), point.intensity),
                      fmt::format("0 (static) or 1 (dynamic), as KTH's truth{}", advice));
    }
    truth.push_back(point.intensity == 1.0F ? kMovingLabel : kStaticLabel);
  }
  return truth;
}

KthSequence::KthSequence(std::string name, const std::filesystem::path& folder) {
  Recording& recording = mutable_recording();
  recording.name = SequenceName(std::move(name), folder);
  for (StemFile& scan : list_scan_folder(folder / "pcd")) {
    const PcdHeader header = read_pcd_header(scan.file);
    if (!header.viewpoint) {
      throw DataError(scan.file, "has no line VIEWPOINT", "the sensor's pose there");
    }
    ScanEntry& entry = recording.scans.emplace_back();
    entry.stem = std::move(scan.stem);
    entry.file = std::move(scan.file);
    entry.map_from_sensor = *header.viewpoint;
    entry.points = header.points;
    entry.has_truth = true;
  }
  recording.remarks = {"points are turned from the map's into the sensor's frame by VIEWPOINT",
                       "intensity is taken as truth (1 is moving) and not passed on"};
  recording.reading.scan_files = ".pcd of pcd/, in the map's frame";
  recording.reading.poses = {.source = "VIEWPOINT of each scan",
                             .direction = PoseDirection::kMapFromSensor,
                             .frame = PoseFrame::kLidar};
}

void KthSequence::read(std::size_t scan_index, Frame& frame) const {
  describe(scan_index, frame);
  frame.points = read_pcd(*scan_file(scan_index));
  frame.truth = kth_truth(frame.points, *scan_file(scan_index), other_scans());
  const Pose sensor_from_map = frame.map_from_sensor.inverse();
  for (Point& point : frame.points) {
    const Eigen::Vector3d p = sensor_from_map * Eigen::Vector3d(point.x, point.y, point.z);
    point = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0.0F};
  }
}

std::vector<std::uint32_t> KthSequence::read_truth(std::size_t scan_index) const {
  return kth_truth(read_pcd(*scan_file(scan_index)), *scan_file(scan_index), other_scans());
}

}  // namespace mosbench
