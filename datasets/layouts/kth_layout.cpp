#include "datasets/layouts/kth_layout.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "datasets/formats/pcd_file.hpp"
#include "datasets/formats/scan_file.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/sequence/sequence.hpp"
#include "datasets/text/errors.hpp"

namespace mosbench {
namespace {

std::string other_scans() {
  return "; " + option("dataset", "semantickitti") + " reads other scans";
}

/// One sequence of KTH's DynamicMap_Benchmark: pcd/*.pcd with points in the map's frame, the
/// sensor's pose in VIEWPOINT, and in intensity 1 for what is dynamic. Frames have the points in
/// the sensor's frame and without intensity, which is the truth and hidden from a method. Reading
/// throws DataError for an intensity other than 0 and 1.
class KthSequence : public Sequence {
 public:
  /// Throws DataError when a scan has no VIEWPOINT.
  KthSequence(std::string name, const std::filesystem::path& folder) {
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

  using Sequence::read;

  void read(std::size_t scan_index, Frame& frame) const override {
    describe(scan_index, frame);
    frame.points = read_pcd(*scan_file(scan_index));
    frame.truth = kth_truth(frame.points, *scan_file(scan_index), other_scans());
    const Pose sensor_from_map = frame.map_from_sensor.inverse();
    for (Point& point : frame.points) {
      const Eigen::Vector3d p = sensor_from_map * Eigen::Vector3d(point.x, point.y, point.z);
      point = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()),
               0.0F};
    }
  }

  std::vector<std::uint32_t> read_truth(std::size_t scan_index) const override {
    return kth_truth(read_pcd(*scan_file(scan_index)), *scan_file(scan_index), other_scans());
  }
};

std::vector<SequenceFolder> list_kth(const std::filesystem::path& path) {
  return list_with(path, "pcd");
}

std::unique_ptr<Sequence> open_kth(const SequenceFolder& sequence, const Reading&) {
  return std::make_unique<KthSequence>(sequence.name, sequence.folder);
}

std::optional<std::string> recognise_kth(const std::filesystem::path& path) {
  if (any_holds(list_kth(path), "gt_cloud.pcd")) return "pcd/ and gt_cloud.pcd are there";
  return std::nullopt;
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

const Layout& kth_layout() {
  static const Layout row = {
      .name = "kth",
      .usual = {"kth", "semantickitti-mos"},
      .title = "KTH DynamicMap_Benchmark, ITSC 2023",
      .content = "windows of KITTI, Argoverse 2 and an indoor recording",
      .size = "see its page",
      .published = "github.com/KTH-RPL/DynamicMap_Benchmark, zenodo 10886629",
      .licence = kUnknownLicence,
      .folders = {"<root>/<sequence>/",
                  "  pcd/%06d.pcd   points in the map's frame, pose in VIEWPOINT, intensity 1 is "
                  "dynamic",
                  "  gt_cloud.pcd   read by mosbench score alone; identifies the layout"},
      .files = {.label_ids = {kStaticLabel, kMovingLabel}, .sensor_range_m = 450.0},
      .expected =
          "folders with pcd/*.pcd in the map's frame (KTH DynamicMap_Benchmark), or one such "
          "folder",
      .list = list_kth,
      .open = open_kth,
      .only_own_poses = "whose scans hold their poses in VIEWPOINT",
      .evidence = Evidence::kFolders,
      .recognise = recognise_kth};
  return row;
}

}  // namespace mosbench
