#include <fmt/format.h>

#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_drive_sequence.hpp"
#include "datasets/layouts/kitti_drive_writer.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

bool is_drive(const fs::path& folder) { return is_there(folder / "velodyne_points" / "data"); }

/// "2011_09_26_drive_0001" of "2011_09_26_drive_0001_sync".
std::string drive_alias(const std::string& name) {
  constexpr std::string_view kEnd = "_sync";
  return name.ends_with(kEnd) ? name.substr(0, name.size() - kEnd.size()) : name;
}

/// Leaves out unsynchronized drives, whose scans are text and which may lie beside the others.
std::vector<SequenceFolder> drives_in(const fs::path& date) {
  std::vector<SequenceFolder> drives;
  for (const fs::path& folder : list_folders(date)) {
    const std::string name = folder_name(folder);
    if (is_drive(folder) && !name.ends_with("_extract"))
      drives.push_back({name, folder, drive_alias(name)});
  }
  return drives;
}

std::vector<SequenceFolder> list_kitti_raw(const fs::path& path) {
  if (is_drive(path)) return {{folder_name(path), path, drive_alias(folder_name(path))}};
  if (auto drives = drives_in(path); !drives.empty()) return drives;
  std::vector<SequenceFolder> drives;
  for (const fs::path& date : list_folders(path)) {
    for (SequenceFolder& drive : drives_in(date)) drives.push_back(std::move(drive));
  }
  return drives;
}

std::unique_ptr<Sequence> open_kitti_raw(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<KittiDriveSequence>(read_raw_drive(sequence.name, sequence.folder),
                                              asked);
}

std::optional<std::string> recognise_kitti_raw(const fs::path& path) {
  const auto drives = list_kitti_raw(path);
  if (drives.empty()) return std::nullopt;
  return fmt::format("{} has velodyne_points/data", drives.front().name);
}

fs::path kitti_raw_folder(const std::string& name, std::size_t) {
  return fs::path("date") / flat_name(name);
}

}  // namespace

const Layout& kitti_raw_layout() {
  static const Layout row = {
      .name = "kitti-raw",
      .usual = {"kitti-raw", "semantickitti-mos"},
      .title = "KITTI raw data, IJRR 2013, with truth made of its tracklets",
      .content = "Velodyne HDL-64E on a car, 10 Hz, boxes of objects in the camera's view",
      .size = "see its page",
      .published = "cvlibs.net/datasets/kitti/raw_data.php",
      .licence = "CC BY-NC-SA 3.0",
      .folders = {"<root>/<date>/                      2011_09_26 and so on",
                  "  calib_{imu_to_velo,velo_to_cam,cam_to_cam}.txt",
                  "  <date>_drive_<number>_sync/", "    velodyne_points/data/*.bin, timestamps.txt",
                  "    oxts/data/*.txt, timestamps.txt",
                  "    tracklet_labels.xml             for truth"},
      .files = {.label_ids = {0, kStaticLabel, kMovingLabel}, .sensor_range_m = 130.0},
      .expected =
          "<date>/<drive>/velodyne_points/data/*.bin of KITTI's raw data, a date or one drive",
      .list = list_kitti_raw,
      .open = open_kitti_raw,
      .no_point_times = [](const std::filesystem::path&) -> std::string {
        return "the points of KITTI's drives have no times, expected azimuth or none";
      },
      .splits = nullptr,
      .evidence = Evidence::kFolders,
      .recognise = recognise_kitti_raw,
      .writer = LayoutWriter{.open = write_as_kitti_raw,
                             .folder = kitti_raw_folder,
                             .files = files_of_kitti_raw,
                             .last_file = [](const WriteOptions&) { return kKittiRawLastFile; },
                             .keeps = KeptTruth::kInView},
      .truth_by_speed = true,
      .simulation = LayoutSimulation{
          .recordings = {{"date/{}", "{}", SensorKind::kHdl64e}},
          .label = kitti_label_in_view,
          .stem = [](std::size_t k, std::int64_t) { return fmt::format("{:010}", k); }}};
  return row;
}

}  // namespace mosbench
