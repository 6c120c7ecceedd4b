#include "datasets/layouts/folder_search.hpp"
#include "datasets/layouts/layout.hpp"

namespace mosbench {
namespace {

std::vector<SequenceFolder> list_mdetector(const std::filesystem::path& path) {
  return list_with(path, "velodyne");
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
      .kind = DatasetKind::kMdetector,
      .name = "mdetector",
      .title = "M-detector's sets, Nature Communications 2024",
      .content = "Livox Avia, KITTI, nuScenes and Waymo",
      .size = "45, 20, 10 and 44 sequences, scans in bags",
      .published = "github.com/hku-mars/M-detector",
      .licence = kUnknownLicence,
      .folders = {"<root>/sequences/0000/, M-detector in some folder's name",
                  "  velodyne/*.bin   scans exported from its bag (mosbench convert)",
                  "  labels/*.label   int32, 251 and above dynamic, 65535 ignored", "  poses.txt"},
      // Any id: they are class * 1000 + instance.
      .files = {.sensor_range_m = 450.0},
      .expected =
          "sequences/NNNN with velodyne/ (exported from the bags), labels/ and poses.txt "
          "(M-detector), or one such folder",
      .list = list_mdetector,
      .open = open_kitti,
      .splits = nullptr,
      .evidence = Evidence::kName,
      .recognise = recognise_mdetector,
      .writer = std::nullopt};
  return row;
}

}  // namespace mosbench
