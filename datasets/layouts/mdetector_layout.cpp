#include "datasets/disk/folder_listing.hpp"
#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"
#include "datasets/text/text.hpp"

namespace mosbench {
namespace {

/// Returns the set in whose folder a sequence lies, as the published tables name it, or nothing.
std::optional<std::string> mdetector_set(const std::filesystem::path& sequence) {
  std::filesystem::path folder = parent_folder(sequence);
  if (folder.filename() == "sequences") folder = parent_folder(folder);
  const std::string name = lower_case(folder.filename().string());
  for (const char* set : {"Avia", "KITTI", "nuScenes", "Waymo"}) {
    if (name.find(lower_case(set)) != std::string::npos) return set;
  }
  return std::nullopt;
}

/// Lists the sequences of one set or, in a folder of sets, of all. All sets number theirs from 0000
/// on, so that names begin with the set: KITTI/0000.
std::vector<SequenceFolder> list_mdetector(const std::filesystem::path& path) {
  std::vector<SequenceFolder> sequences = list_with(path, "velodyne");
  if (sequences.empty()) {
    for (const std::filesystem::path& set : list_folders(path)) {
      const auto of_set = list_with(set, "velodyne");
      sequences.insert(sequences.end(), of_set.begin(), of_set.end());
    }
  }
  for (SequenceFolder& sequence : sequences) {
    if (const auto set = mdetector_set(sequence.folder)) {
      sequence.name = *set + '/' + sequence.name;
    }
  }
  return sequences;
}

std::optional<std::string> recognise_mdetector(const std::filesystem::path& path) {
  if (!folder_with_word(path, {"m-detector", "m_detector", "mdetector"}) ||
      list_mdetector(path).empty()) {
    return std::nullopt;
  }
  return "M-detector is in the folder name";
}

}  // namespace

const Layout& mdetector_layout() {
  static const Layout row = {
      .name = "mdetector",
      .usual = {"mdetector", "mdetector"},
      .title = "M-detector's sets, Nature Communications 2024",
      .content = "Livox Avia, KITTI, nuScenes and Waymo",
      .size = "45, 20, 10 and 44 sequences, scans in bags",
      .published = "github.com/hku-mars/M-detector",
      .licence = kUnknownLicence,
      .folders =
          {"<root>/<set>/sequences/0000/, M-detector in some folder's name; set: avia, kitti,",
           "  nuscenes or waymo",
           "  velodyne/*.bin   scans exported from its bag (mosbench convert)",
           "  labels/*.label   int32, 251 and above dynamic, 65535 ignored", "  poses.txt"},
      // Any id: they are class * 1000 + instance.
      .files = {.sensor_range_m = 450.0},
      .expected =
          "sequences/NNNN with velodyne/ (exported from the bags), labels/ and poses.txt "
          "(M-detector), or one such folder",
      .list = list_mdetector,
      .open = open_kitti,
      .evidence = Evidence::kName,
      .recognise = recognise_mdetector};
  return row;
}

}  // namespace mosbench
