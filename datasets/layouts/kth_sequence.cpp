#include "datasets/layouts/kth_sequence.hpp"

#include <utility>

#include "datasets/files/errors.hpp"
#include "datasets/files/pcd_file.hpp"
#include "datasets/files/scan_file.hpp"

namespace mosbench {
namespace {

std::vector<std::uint32_t> truth_of(const std::vector<Point>& points) {
  std::vector<std::uint32_t> truth;
  truth.reserve(points.size());
  for (const Point& point : points) {
    truth.push_back(point.intensity == 1.0F ? kMovingLabel : kStaticLabel);
  }
  return truth;
}

}  // namespace

KthSequence::KthSequence(std::string name, const std::filesystem::path& folder)
    : name_(std::move(name)), scans_(list_scan_folder(folder / "pcd")) {
  for (const StemFile& scan : scans_) {
    const PcdHeader header = read_pcd_header(scan.file);
    if (!header.viewpoint) {
      throw DataError(scan.file, "has no line VIEWPOINT", "the sensor's pose there");
    }
    poses_.push_back(*header.viewpoint);
    point_counts_.push_back(header.points);
  }
}

Frame KthSequence::read_frame(std::size_t scan_index, Frame /*spent*/) const {
  Frame frame;
  frame.stem = stem(scan_index);
  frame.points = read_pcd(scans_[scan_index].file);
  frame.map_from_sensor = poses_[scan_index];
  frame.truth = truth_of(frame.points);
  const Pose sensor_from_map = frame.map_from_sensor.inverse();
  for (Point& point : frame.points) {
    const Eigen::Vector3d p = sensor_from_map * Eigen::Vector3d(point.x, point.y, point.z);
    point = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0.0F};
  }
  return frame;
}

std::vector<std::uint32_t> KthSequence::read_truth(std::size_t scan_index) const {
  return truth_of(read_pcd(scans_.at(scan_index).file));
}

std::vector<std::filesystem::path> KthSequence::files() const {
  std::vector<std::filesystem::path> files;
  for (const StemFile& scan : scans_) files.push_back(scan.file);
  return files;
}

std::vector<std::string> KthSequence::remarks() const {
  return {"points are turned from the map's into the sensor's frame by VIEWPOINT",
          "intensity is taken as truth (1 is moving) and not passed on"};
}

ReadingStatement KthSequence::reading() const {
  return {{"scan_files", ".pcd of pcd/, in the map's frame"},
          {"poses", "VIEWPOINT of each scan"},
          {"pose_direction", "map_from_sensor"},
          {"pose_frame", "lidar"}};
}

}  // namespace mosbench
