#include <fmt/format.h>

#include "datasets/disk/folder_listing.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/helipr_sequence.hpp"
#include "datasets/layouts/helipr_writer.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;

bool is_helipr_lidar(const fs::path& folder) {
  return helipr_sensor_from_string(folder_name(folder)) &&
         folder_name(parent_folder(folder)) == "LiDAR" && !list_by_stem(folder, {".bin"}).empty();
}

/// Whether a recording is called after its LiDAR, as `convert` calls it: "Roundabout01_Aeva".
bool is_called_after(const fs::path& recording, const fs::path& lidar) {
  return folder_name(recording).ends_with("_" + folder_name(lidar));
}

/// Lists the LiDARs of one recording, each called `prefix` and its own name.
std::vector<SequenceFolder> lidars_of(const fs::path& recording, const std::string& prefix) {
  std::vector<SequenceFolder> sequences;
  for (const fs::path& folder : list_folders(recording / "LiDAR")) {
    if (!is_helipr_lidar(folder)) continue;
    sequences.push_back({prefix + folder_name(folder), folder, ""});
  }
  return sequences;
}

std::vector<SequenceFolder> list_helipr(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return {};
  if (is_helipr_lidar(path)) return {{folder_name(path), path, ""}};
  if (auto sequences = lidars_of(path, ""); !sequences.empty()) return sequences;
  std::vector<SequenceFolder> sequences;
  for (const fs::path& recording : list_folders(path)) {
    auto lidars = lidars_of(recording, folder_name(recording) + "/");
    if (lidars.size() == 1 && is_called_after(recording, lidars.front().folder)) {
      lidars.front().name = folder_name(recording);
    }
    sequences.insert(sequences.end(), lidars.begin(), lidars.end());
  }
  return sequences;
}

std::unique_ptr<Sequence> open_helipr(const SequenceFolder& sequence, const Reading& asked) {
  return std::make_unique<HeliprSequence>(sequence.name, sequence.folder, asked);
}

std::optional<std::string> recognise_helipr(const fs::path& path) {
  const auto sequences = list_helipr(path);
  if (sequences.empty()) return std::nullopt;
  return "packed scans of HeLiPR's " + folder_name(sequences.front().folder) + " are there";
}

fs::path helipr_folder(const std::string& name, std::size_t) { return flat_name(name); }

}  // namespace

const Layout& helipr_layout() {
  static const Layout row = {
      .name = "helipr",
      .usual = {"helipr", "semantickitti-mos"},
      .title = "HeLiPR, IJRR 2024, as recorded",
      .content = "Aeva, Livox Avia, Ouster OS2-128 and Velodyne VLP-16 on one car",
      .size = "see its page",
      .published = "sites.google.com/view/heliprdataset",
      .licence = "CC BY-NC-SA 4.0",
      .folders = {"<root>/<recording>/", "  LiDAR/{Aeva,Avia,Ouster,Velodyne}/<stamp_ns>.bin",
                  "  LiDAR_GT/<sensor>_gt.txt       stamp_ns x y z qx qy qz qw",
                  "no labels: HeLiMOS has those of KAIST05"},
      .files = {.sensor_range_m = 450.0},
      .expected =
          "LiDAR/{Aeva,Avia,Ouster,Velodyne}/<stamp_ns>.bin and LiDAR_GT/ (HeLiPR), a folder of "
          "such "
          "recordings, or one such folder of scans",
      .list = list_helipr,
      .open = open_helipr,
      .splits = nullptr,
      .evidence = Evidence::kFolders,
      .recognise = recognise_helipr,
      .writer = LayoutWriter{.open = write_as_helipr,
                             .folder = helipr_folder,
                             .files = files_of_helipr,
                             .last_file = helipr_last_file,
                             .keeps = KeptTruth::kNone,
                             .keeps_radial_velocities = true},
      .simulation = LayoutSimulation{
          .recordings = {{"{}", "{}/Aeva", SensorKind::kAeva},
                         {"{}", "{}/Ouster", SensorKind::kOs2_128}},
          .truth = "There is no truth: HeLiPR has no place for it.",
          .is_global = true,
          .stem = [](std::size_t, std::int64_t stamp_ns) { return std::to_string(stamp_ns); }}};
  return row;
}

}  // namespace mosbench
