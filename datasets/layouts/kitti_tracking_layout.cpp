#include "datasets/disk/files.hpp"
#include "datasets/disk/folder_listing.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/kitti_drive_sequence.hpp"
#include "datasets/layouts/kitti_drive_writer.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

bool is_sequence(const fs::path& folder) {
  return stem_number(folder_name(folder)) && !list_by_stem(folder, {".bin"}).empty();
}

/// Lists velodyne/NNNN of training/ or testing/.
std::vector<SequenceFolder> sequences_in(const fs::path& part, const std::string& prefix) {
  std::vector<SequenceFolder> sequences;
  for (const fs::path& folder : list_folders(part / "velodyne")) {
    const std::string number = folder_name(folder);
    if (is_sequence(folder)) {
      sequences.push_back({prefix + number, folder, prefix.empty() ? "" : number});
    }
  }
  return sequences;
}

/// Whether a folder is velodyne/, beside which one of the other folders lies.
bool is_of_benchmark(const fs::path& velodyne) {
  const fs::path part = parent_folder(velodyne);
  return folder_name(velodyne) == "velodyne" &&
         (is_there(part / "oxts") || is_there(part / "calib") || is_there(part / "label_02"));
}

/// Those of a root: training/ has labels, testing/ is read where it is given itself.
std::vector<SequenceFolder> sequences_of(const fs::path& root, const std::string& prefix) {
  auto sequences = sequences_in(root / "training", prefix);
  return sequences.empty() ? sequences_in(root, prefix) : sequences;
}

std::vector<SequenceFolder> list_kitti_tracking(const fs::path& path) {
  if (is_of_benchmark(path)) return sequences_in(parent_folder(path), "");
  if (is_of_benchmark(parent_folder(path)) && is_sequence(path)) {
    return {{folder_name(path), path, ""}};
  }
  auto sequences = sequences_of(path, "");
  if (!sequences.empty()) return sequences;
  for (const fs::path& root : list_folders(path)) {
    for (SequenceFolder& sequence : sequences_in(root / "training", folder_name(root) + "/")) {
      sequences.push_back(std::move(sequence));
    }
  }
  return sequences;
}

std::unique_ptr<Sequence> open_kitti_tracking(const SequenceFolder& sequence,
                                              const Reading& asked) {
  return std::make_unique<KittiDriveSequence>(read_tracking_drive(sequence.name, sequence.folder),
                                              asked);
}

/// Scans alone may lie in such folders elsewhere, too, and one given itself with poses of its own.
std::optional<std::string> recognise_kitti_tracking(const fs::path& path) {
  const auto sequences = list_kitti_tracking(path);
  if (sequences.empty()) return std::nullopt;
  const fs::path& first = sequences.front().folder;
  const bool has_own_poses = first == path && is_there(path / "poses.txt");
  if (has_own_poses || !is_of_benchmark(parent_folder(first))) return std::nullopt;
  return "scans are in velodyne/" + folder_name(sequences.front().folder);
}

std::optional<std::string> recognise_part_of_kitti_tracking(const fs::path& path) {
  const auto sequences = list_kitti_tracking(path);
  if (sequences.empty()) return std::nullopt;
  return "scans are in velodyne/" + folder_name(sequences.front().folder);
}

fs::path kitti_tracking_folder(const std::string& name, std::size_t) { return flat_name(name); }

}  // namespace

const Layout& kitti_tracking_layout() {
  static const Layout row = {
      .name = "kitti-tracking",
      .usual = {"kitti-tracking", "semantickitti-mos"},
      .title = "KITTI tracking, CVPR 2012, with truth made of its boxes",
      .content = "Velodyne HDL-64E on a car, 10 Hz, boxes of objects in the camera's view",
      .size = "21 sequences with labels, 29 without",
      .published = "cvlibs.net/datasets/kitti/eval_tracking.php",
      .licence = "CC BY-NC-SA 3.0",
      .folders = {"<root>/training/", "  velodyne/<number>/*.bin", "  oxts/<number>.txt",
                  "  calib/<number>.txt", "  label_02/<number>.txt    for truth",
                  "<root>/<folder>/           such roots, as convert writes them"},
      .files = {.label_ids = {0, kStaticLabel, kMovingLabel}, .sensor_range_m = 130.0},
      .expected =
          "training/{velodyne/<number>/*.bin,oxts,calib,label_02} of KITTI's tracking benchmark",
      .list = list_kitti_tracking,
      .open = open_kitti_tracking,
      .no_point_times = [](const std::filesystem::path&) -> std::string {
        return "the points of KITTI's drives have no times, expected azimuth or none";
      },
      .splits = nullptr,
      .evidence = Evidence::kFolders,
      .recognise = recognise_kitti_tracking,
      .recognise_part = recognise_part_of_kitti_tracking,
      .writer =
          LayoutWriter{.open = write_as_kitti_tracking,
                       .folder = kitti_tracking_folder,
                       .files = files_of_kitti_tracking,
                       .last_file = [](const WriteOptions&) { return kKittiTrackingLastFile; },
                       .keeps = KeptTruth::kInView,
                       .keeps_stamps = false},
      .truth_by_speed = true,
      .simulation = LayoutSimulation{.recordings = {{"{}", "{}/0000", SensorKind::kHdl64e}},
                                     .label = kitti_label_in_view,
                                     .stamp_ns = no_stamp}};
  return row;
}

}  // namespace mosbench
