#include "datasets/disk/files.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_sequence.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

constexpr const char* kApolloPoses = "velodyne_poses_kitti.txt";

std::vector<SequenceFolder> list_apollo(const std::filesystem::path& path) {
  return list_with(path, "velodyne");
}

std::unique_ptr<Sequence> open_apollo(const SequenceFolder& sequence, const Reading& asked) {
  SequenceLayout layout;
  if (is_there(sequence.folder / kApolloPoses)) {
    layout.folder.poses_file = kApolloPoses;
    layout.folder.poses_of_lidar = true;
  }
  return std::make_unique<KittiSequence>(sequence.name, sequence.folder, asked, layout);
}

std::optional<std::string> recognise_apollo(const std::filesystem::path& path) {
  if (any_holds(list_apollo(path), kApolloPoses)) return std::string(kApolloPoses) + " is there";
  return std::nullopt;
}

}  // namespace

const Layout& apollo_layout() {
  static const Layout row = {
      .name = "apollo",
      .usual = {"apollo", "semantickitti-mos"},
      .title = "Apollo, labelled by the authors of 4DMOS",
      .content = "Velodyne HDL-64E on a car",
      .size = "00: 2000 scans and 03: 500 scans in the HMM-MOS paper's program",
      .published = "LiDAR-MOS.zip of ipb.uni-bonn.de",
      .licence = kUnknownLicence,
      .folders = {"<root>/sequences/00, 03, .../ (of LiDAR-MOS.zip)", "  velodyne/%06d.bin",
                  "  labels/%06d.label", "  velodyne_poses_kitti.txt   lidar frame, or",
                  "  poses.txt and calib.txt    camera frame"},
      .files = {.label_ids = semantickitti_label_ids(), .sensor_range_m = 200.0},
      .expected =
          "sequences/NN with velodyne/, labels/ and velodyne_poses_kitti.txt or poses.txt "
          "and calib.txt (Apollo of LiDAR-MOS), or one such folder",
      .list = list_apollo,
      .open = open_apollo,
      .evidence = Evidence::kFolders,
      .recognise = recognise_apollo};
  return row;
}

}  // namespace mosbench
